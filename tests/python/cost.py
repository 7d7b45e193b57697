"""Measures the overhead of Python per step of a large crowd, and the time to convert ten million events to arrays.

Usage: cost.py [PEOPLE [STEPS]], with the module in PYTHONPATH. The overhead is measured within one run: the time of
step() and of reading arrays, minus the library's time of the step.
"""

import os
import statistics
import struct
import sys
import tempfile
import time

import numpy
import throng

EVENTS_PER_FRAME = 2000
EVENTS = 10_000_000


def step_cost(people, steps):
    simulation = throng.Simulation("city_square", avatars=people)
    library, added, total = [], [], 0
    for number in range(steps + 5):
        start_s = time.perf_counter()
        frame = simulation.step()
        total += len(frame.positions_m) + len(frame.rotations_xyzw) + len(frame.speeds_mps)
        total += len(frame.present) + len(frame.events) + len(frame.pairs)
        whole_ms = 1000 * (time.perf_counter() - start_s)
        if number >= 5:  # skips the first frames, which are larger
            library.append(simulation.step_ms)
            added.append(whole_ms - simulation.step_ms)
    step, more = statistics.median(library), statistics.median(added)
    share = statistics.median(a / s for a, s in zip(added, library))
    print(f"step of {people} people: {step:.1f} ms in the library, {more:.2f} ms added by Python, {100 * share:.2f} %")


def log_of_events(file, folder):
    """Writes a log with the description of a real run and many events."""
    real = os.path.join(folder, "real.lcmlog")
    throng.run("corridor", seconds=1 / 60, log=real)
    pairs = numpy.arange(EVENTS_PER_FRAME // 2)
    frames = EVENTS // EVENTS_PER_FRAME
    with open(real, "rb") as log, open(file, "wb") as out:
        number = 0

        def put(channel, data):
            nonlocal number
            out.write(struct.pack(">Iqqii", 0xEDA1DA01, number, 0, len(channel), len(data)) + channel + data)
            number += 1

        head = throng.events_t()
        while begin := log.read(28):
            channel_bytes, data_bytes = struct.unpack(">20xii", begin)
            channel, data = log.read(channel_bytes), log.read(data_bytes)
            if channel in (b"THRONG_RUN", b"THRONG_STATES"):
                put(channel, data)
                head.run_id, head.instance, head.schema = struct.unpack(">8x8xqq8x8x4x4xi", data[:60])
        head.chunk_count, head.count = 1, EVENTS_PER_FRAME
        head.a = [int(pair) for pair in pairs] * 2
        head.b = [int(pair) + 100_000 for pair in pairs] * 2
        head.part_a = head.part_b = bytes(EVENTS_PER_FRAME)
        head.level = bytes([2]) * EVENTS_PER_FRAME
        head.kind = bytes([1]) * (EVENTS_PER_FRAME // 2) + bytes(EVENTS_PER_FRAME // 2)
        for frame in range(frames):
            head.frame = head.seq = frame
            put(b"THRONG_EVENTS", head.encode())


def events_cost():
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "events.lcmlog")
        log_of_events(file, folder)
        start_s = time.perf_counter()
        log = throng.read_log(file, trajectories=False)
        read_s = time.perf_counter() - start_s
        start_s = time.perf_counter()
        contacts = len(log.contacts)
        print(
            f"{len(log.events)} events from a log of {os.path.getsize(file) / 1e6:.0f} MB: {read_s:.2f} s; "
            f"{contacts} contacts paired in {time.perf_counter() - start_s:.2f} s"
        )


if __name__ == "__main__":
    step_cost(*(int(word) for word in (sys.argv[1:] + ["100000", "40"][len(sys.argv) - 1 :])))
    events_cost()
