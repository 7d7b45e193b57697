"""Print a line per simulated minute of a log: numbers of people present, of walking ones, and of begun contacts.

minutes.py LOG; needs the message types for Python (build/release/python) in PYTHONPATH.
"""
import struct
import sys

from throng import events_t, states_t

WALKS_MPS = 0.1


class Minute:
    def __init__(self):
        self.there, self.walking, self.begun = {}, {}, 0

    def add_states(self, m):
        for i in range(m.avatar_count):
            if m.present_count == 0 or m.present[i]:
                self.there[m.first_avatar + i] = True
                if m.speed_mps[i] > WALKS_MPS:
                    self.walking[m.first_avatar + i] = True


def main():
    minutes = {}
    next_states_us = 0
    with open(sys.argv[1], "rb") as log:
        while len(head := log.read(28)) == 28:  # magic, event number, time stamp, and the two lengths
            stamp_us, channel_bytes, data_bytes = struct.unpack(">12xqii", head)
            channel = log.read(channel_bytes)
            # The first states of a minute suffice.
            is_used = channel == b"THRONG_EVENTS" or (
                channel == b"THRONG_STATES" and stamp_us >= next_states_us)
            if not is_used:
                log.seek(data_bytes, 1)
                continue
            data = log.read(data_bytes)
            minute = minutes.setdefault(stamp_us // 60_000_000, Minute())
            if channel == b"THRONG_EVENTS":
                minute.begun += events_t.decode(data).kind.count(0)
            else:
                m = states_t.decode(data)
                minute.add_states(m)
                if m.chunk + 1 == m.chunk_count:
                    next_states_us = (stamp_us // 60_000_000 + 1) * 60_000_000
    for number, minute in sorted(minutes.items()):
        print(f"{number}: {len(minute.there)} there, {len(minute.walking)} walking, {minute.begun} begun")


main()
