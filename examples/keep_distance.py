"""keep_distance.py [SLEEP_S]: controls the robot of keep_distance.yaml, slower near people."""
import random, socket, struct, sys, time
from throng import step_reply_t, end_t, proximity_t, step_request_t

GROUP, PORT = "239.255.76.67", 7684
bus = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # LCM without liblcm, for messages of one datagram
bus.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
bus.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 21)
bus.bind((GROUP, PORT))
bus.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + bytes(4))
bus.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

instance, frame, chunks = 0, -1, 0  # latest proximity rows
separation: dict[int, float] = {}  # least distance of each robot


def drive(request: step_request_t, answer: step_reply_t, i: int) -> None:
    """Control law: full speed from 0.6 m on, zero at 0.2 m; brakes at 4 m/s2, accelerates at 1 m/s2."""
    ahead = 1 if request.qw[i] > request.qz[i] else -1  # along x or against it; turns at the ends
    if ahead * request.x_m[i] > 6:
        ahead = -ahead
    answer.qw[i], answer.qz[i] = (1, 0) if ahead > 0 else (0, 1)
    min_distance_m = separation.get(request.avatar[i], 0.6)
    target_mps = 1.2 * min(max((min_distance_m - 0.2) / 0.4, 0.0), 1.0)
    speed_mps = min(max(target_mps, abs(request.vx_mps[i]) - 4 / 60), abs(request.vx_mps[i]) + 1 / 60, 1.2)
    speed_mps = max(speed_mps, 0.0)
    answer.x_m[i] += ahead * speed_mps / 60
    answer.vx_mps[i] = ahead * speed_mps


while True:
    packet = bus.recv(65536)
    name, _, data = packet[8:].partition(b"\0")
    if name == b"THRONG_PROXIMITY":
        message = proximity_t.decode(data)
        if message.frame != frame:
            frame, chunks, separation = message.frame, 0, {}
        chunks += 1
        is_complete = chunks == message.chunk_count
        for a, b, lo_m in zip(message.a, message.b, message.distance_lo_m):
            for body in (a, b):
                separation[body] = min(lo_m, separation.get(body, lo_m))
    elif name == b"PICKER_REQUEST":
        request, answer = step_request_t.decode(data), step_reply_t()
        instance = request.instance
        if not request.is_first and not (frame == request.frame and is_complete):
            sys.exit(f"frame {request.frame}: proximity rows were lost")
        for field in set(answer.__slots__) & set(request.__slots__):
            setattr(answer, field, getattr(request, field))  # run, frame, avatars and poses
        for column in ("x_m", "qw", "qz", "vx_mps"):
            setattr(answer, column, list(getattr(request, column)))
        for i in range(0 if request.is_first else request.count):
            drive(request, answer, i)
        time.sleep(random.uniform(0, float(sys.argv[1]) if len(sys.argv) > 1 else 0))
        bus.sendto(b"LC02\0\0\0\0PICKER_REPLY\0" + answer.encode(), (GROUP, PORT))
    elif name == b"THRONG_END" and end_t.decode(data).instance == instance:
        break
