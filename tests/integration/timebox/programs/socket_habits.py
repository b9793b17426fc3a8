#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""What programs do with IP sockets, one habit each, and what the manuals say that they see. Prints `ok NAME`, or what went wrong."""
import array
import errno
import fcntl
import os
import select
import socket
import struct
import sys
import termios
import threading
import time
import traceback

OWN, NEIGHBOUR, NOBODY, GROUP = sys.argv[1:5]
PATTERN = bytes(i * 31 % 256 for i in range(251)) * 4000


def stream_pair(address="127.0.0.1"):
    listener = socket.create_server((address, 0))
    client = socket.create_connection(listener.getsockname())
    server, peer = listener.accept()
    assert peer == client.getsockname(), (peer, client.getsockname())
    listener.close()
    return client, server


def error_of(attempt):
    try:
        attempt()
    except OSError as e:
        return errno.errorcode[e.errno or 0] if e.errno else type(e).__name__
    return None


def names():
    for address in ("127.0.0.1", OWN):
        client, server = stream_pair(address)
        assert client.getpeername() == server.getsockname() and server.getsockname()[0] == address
        assert client.family == socket.AF_INET and client.getsockopt(socket.SOL_SOCKET, socket.SO_DOMAIN) == socket.AF_INET
        assert client.getsockopt(socket.SOL_SOCKET, socket.SO_PROTOCOL) == socket.IPPROTO_TCP
    assert error_of(lambda: socket.socket().getpeername()) == "ENOTCONN"
    assert error_of(lambda: socket.socket().bind((NOBODY, 0))) == "EADDRNOTAVAIL"


def large_sends_wait_and_arrive():
    client, server = stream_pair()
    got = bytearray()

    def read():
        while data := server.recv(50_000):
            time.sleep(0.0001)
            got.extend(data)

    reader = threading.Thread(target=read)
    reader.start()
    client.sendall(PATTERN)
    client.shutdown(socket.SHUT_WR)
    reader.join()
    assert bytes(got) == PATTERN, len(got)
    server.sendall(b"back")
    assert client.recv(10) == b"back"


def all_of_it_or_the_end():
    client, server = stream_pair()
    threading.Timer(0.01, lambda: client.send(b"12345")).start()
    threading.Timer(0.02, lambda: client.send(b"67890")).start()
    begun = time.monotonic()
    assert server.recv(10, socket.MSG_WAITALL) == b"1234567890"
    assert 0.0195 < time.monotonic() - begun < 0.021, time.monotonic() - begun
    client.send(b"abc")
    assert server.recv(2, socket.MSG_PEEK) == b"ab"
    assert array.array("i", fcntl.ioctl(server, termios.FIONREAD, bytes(4)))[0] == 3
    client.close()
    assert server.recv(10, socket.MSG_WAITALL) == b"abc" and server.recv(1) == b""


def timeouts():
    client, server = stream_pair()
    server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("ll", 0, 30_000))
    begun = time.monotonic()
    assert error_of(lambda: server.recv(1)) == "EAGAIN"
    assert abs(time.monotonic() - begun - 0.03) < 1e-4, time.monotonic() - begun
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.settimeout(0.02)
    assert error_of(lambda: udp.recv(1)) == "TimeoutError"


def not_waiting():
    client, server = stream_pair()
    client.setblocking(False)
    assert error_of(lambda: client.recv(1)) == "EAGAIN"
    sent = 0
    while True:
        try:
            sent += client.send(PATTERN)
        except BlockingIOError:
            break
    assert sent > 60_000
    assert not select.select([], [client], [], 0)[1]
    got = 0
    while got < sent:
        got += len(server.recv(1 << 20))
        if got == sent:
            break
    assert select.select([], [client], [], 1)[1]


def connect_without_waiting():
    listener = socket.create_server((OWN, 0))
    for address, wanted in ((listener.getsockname(), 0), ((OWN, 9), errno.ECONNREFUSED)):
        s = socket.socket()
        s.setblocking(False)
        result = s.connect_ex(address)
        assert result in (errno.EINPROGRESS, wanted), result
        if result == errno.EINPROGRESS:
            poll = select.poll()
            poll.register(s, select.POLLOUT)
            assert poll.poll(1000)
            assert s.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) == wanted
    far = socket.socket()
    far.setblocking(False)
    assert far.connect_ex((NEIGHBOUR, 7)) == errno.EINPROGRESS
    assert far.connect_ex((NEIGHBOUR, 7)) == errno.EALREADY
    watch = select.epoll()
    watch.register(far, select.EPOLLOUT | select.EPOLLIN | select.EPOLLET)
    assert watch.poll(0) == []
    events = watch.poll(1)
    assert events == [(far.fileno(), select.EPOLLOUT)], events
    assert far.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) == 0
    assert far.getpeername() == (NEIGHBOUR, 7)
    refused = socket.socket()
    refused.setblocking(False)
    assert refused.connect_ex((NEIGHBOUR, 99)) == errno.EINPROGRESS
    watch.register(refused, select.EPOLLOUT)
    events = dict(watch.poll(1))
    assert events[refused.fileno()] & (select.EPOLLERR | select.EPOLLHUP), events
    assert refused.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) == errno.ECONNREFUSED
    far.close()


def nobody_there():
    assert error_of(lambda: socket.create_connection((OWN, 9))) == "ECONNREFUSED"
    assert error_of(lambda: socket.create_connection((NEIGHBOUR, 9))) == "ECONNREFUSED"
    assert error_of(lambda: socket.create_connection((NOBODY, 9))) == "EHOSTUNREACH"
    assert error_of(lambda: socket.create_connection(("192.0.2.1", 9))) == "EHOSTUNREACH"


def epoll_of_a_stream():
    client, server = stream_pair()
    server.setblocking(False)
    watch = select.epoll()
    watch.register(server, select.EPOLLIN | select.EPOLLOUT | select.EPOLLRDHUP | select.EPOLLET)
    assert watch.poll(0) == [(server.fileno(), select.EPOLLOUT)]
    assert watch.poll(0.01) == []
    client.send(b"x")
    assert watch.poll(1) == [(server.fileno(), select.EPOLLIN | select.EPOLLOUT)]
    assert watch.poll(0.01) == []  # edge
    client.shutdown(socket.SHUT_WR)
    (_, events), = watch.poll(1)
    assert events & select.EPOLLRDHUP and not events & select.EPOLLHUP, events
    assert server.recv(10) == b"x" and server.recv(10) == b""
    server.send(b"still")
    assert client.recv(10) == b"still"
    server.close()
    assert client.recv(10) == b""


def resets():
    client, server = stream_pair()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()
    time.sleep(0.001)
    assert error_of(lambda: server.recv(1)) == "ECONNRESET"
    client, server = stream_pair()
    server.send(b"never read")
    time.sleep(0.001)
    client.close()  # with something unread
    time.sleep(0.001)
    assert error_of(lambda: server.recv(1)) == "ECONNRESET"
    assert error_of(lambda: server.send(b"x")) == "EPIPE"


def forked_and_duplicated():
    listener = socket.create_server(("127.0.0.1", 0))
    child = os.fork()
    if child == 0:
        s = socket.create_connection(listener.getsockname())
        s.sendall(b"from the child")
        os._exit(0)
    server, _ = listener.accept()
    copy = socket.socket(fileno=os.dup(server.fileno()))
    server.close()
    assert copy.recv(100) == b"from the child" and copy.recv(100) == b""
    os.waitpid(child, 0)


def ports_are_given_back():
    first = socket.create_server(("127.0.0.1", 4000), reuse_port=False)
    other = socket.socket()
    assert error_of(lambda: other.bind(("127.0.0.1", 4000))) == "EADDRINUSE"
    first.close()
    other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    other.bind(("127.0.0.1", 4000))


def datagrams():
    server, client = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    server.bind(("127.0.0.1", 0))
    client.connect(server.getsockname())
    for size in (0, 1, 1472, 1473, 9000):
        client.send(PATTERN[:size])
        assert array.array("i", fcntl.ioctl(server, termios.FIONREAD, bytes(4)))[0] == size
        data, sender = server.recvfrom(10_000)
        assert data == PATTERN[:size] and sender == client.getsockname(), (size, len(data), sender)
    for i in range(30):
        client.send(bytes([i]))
    watch = select.epoll()
    watch.register(server, select.EPOLLIN | select.EPOLLET)
    assert watch.poll(1) and [server.recv(10)[0] for _ in range(30)] == list(range(30))
    assert error_of(lambda: server.recv(1, socket.MSG_DONTWAIT)) == "EAGAIN" and watch.poll(0) == []
    client.send(b"long")
    data, control, flags, sender = server.recvmsg(2, 100)
    assert data == b"lo" and flags & socket.MSG_TRUNC and sender == client.getsockname()
    client.connect(("127.0.0.1", 9))
    client.send(b"x")
    assert error_of(lambda: client.recv(1)) == "ECONNREFUSED"
    assert error_of(lambda: server.sendto(b"x", ("255.255.255.255", 9))) == "EACCES"
    server.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    assert server.getsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST) == 1


def groups():
    listeners = []
    for _ in range(2):
        s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        s.bind(("", 5007))
        s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0"))
        listeners.append(s)
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 4)
    sender.sendto(b"all", (GROUP, 5007))
    for s in listeners:
        assert s.recvfrom(10) == (b"all", (OWN, sender.getsockname()[1]))
    listeners[0].setsockopt(socket.IPPROTO_IP, socket.IP_DROP_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0"))


def options():
    s = socket.socket()
    for level, name in ((socket.IPPROTO_TCP, socket.TCP_NODELAY), (socket.SOL_SOCKET, socket.SO_KEEPALIVE), (socket.SOL_SOCKET, socket.SO_REUSEADDR)):
        assert s.getsockopt(level, name) == 0
        s.setsockopt(level, name, 1)
        assert s.getsockopt(level, name) == 1
    s.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, 0xB8)
    assert s.getsockopt(socket.IPPROTO_IP, socket.IP_TOS) == 0xB8
    assert s.getsockopt(socket.SOL_SOCKET, socket.SO_TYPE) == socket.SOCK_STREAM


def interfaces():
    s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    seen = {name: socket.inet_ntoa(fcntl.ioctl(s, 0x8915, struct.pack("256s", name.encode()))[20:24]) for _, name in socket.if_nameindex() if name in ("lo", "lan")}
    assert seen == {"lo": "127.0.0.1", "lan": OWN}, seen


def files_are_sent():
    client, server = stream_pair()
    with open("/tmp/socket_habits", "w+b") as file:
        file.write(PATTERN[:30_000])
        file.seek(0)
        client.sendfile(file)
    os.unlink("/tmp/socket_habits")
    assert server.recv(30_000, socket.MSG_WAITALL) == PATTERN[:30_000]


def what_is_not_there():
    assert error_of(lambda: socket.socket(socket.AF_INET6)) == "EAFNOSUPPORT"
    assert error_of(lambda: socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_ICMP)) == "EPERM"
    assert error_of(lambda: socket.socket().setsockopt(socket.IPPROTO_TCP, socket.TCP_FASTOPEN, 1)) == "ENOPROTOOPT"


for habit in (names, large_sends_wait_and_arrive, all_of_it_or_the_end, timeouts, not_waiting, connect_without_waiting, nobody_there, epoll_of_a_stream, resets,
              forked_and_duplicated, ports_are_given_back, datagrams, groups, options, interfaces, files_are_sent, what_is_not_there):
    try:
        habit()
        print("ok", habit.__name__, flush=True)
    except BaseException:
        print("failed", habit.__name__, traceback.format_exc().replace("\n", " | "), flush=True)
print("done", flush=True)
