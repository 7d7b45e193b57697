import struct, sys
from throng import events_t

with open(sys.argv[1], "rb") as log:
    while head := log.read(28):  # magic, event number, time stamp, and the two lengths
        channel_bytes, data_bytes = struct.unpack(">20xii", head)
        channel, data = log.read(channel_bytes), log.read(data_bytes)
        if channel == b"THRONG_EVENTS":
            m = events_t.decode(data)
            for pair in zip(m.a, m.part_a, m.b, m.part_b, m.kind):
                print(m.utime / 1e6, "touches" if pair[4] == 0 else "leaves", *pair[:4])
