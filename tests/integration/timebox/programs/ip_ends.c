// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Both ends of UDP and TCP, as anybody writes them. Each line that it prints has times of CLOCK_MONOTONIC, ns.
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/tcp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static int64_t now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}
static void sleep_ms(int ms) {
    struct timespec t = {ms / 1000, ms % 1000 * 1000000L};
    nanosleep(&t, NULL);
}
static struct sockaddr_in address(char const* text, int port) {
    struct sockaddr_in a = {.sin_family = AF_INET, .sin_port = htons(port)};
    inet_pton(AF_INET, text, &a.sin_addr);
    return a;
}
static void must(int ok, char const* what) {
    if (!ok) {
        printf("%s: %s\n", what, strerror(errno));
        exit(1);
    }
}
static uint8_t octet_of(long at) {
    return (uint8_t)(at * 31 + at / 251);
}

static void udp_echo(void) {
    int s = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in own = address("0.0.0.0", 7), from;
    must(bind(s, (struct sockaddr*)&own, sizeof own) == 0, "bind");
    for (;;) {
        char data[2048];
        socklen_t size = sizeof from;
        ssize_t n = recvfrom(s, data, sizeof data, 0, (struct sockaddr*)&from, &size);
        must(n >= 0, "recvfrom");
        must(sendto(s, data, (size_t)n, 0, (struct sockaddr*)&from, size) == n, "sendto");
    }
}

static void udp_ask(char const* server, int times) {
    int s = socket(AF_INET, SOCK_DGRAM, 0);
    struct sockaddr_in to = address(server, 7);
    struct timeval patience = {0, 5000};
    setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sleep_ms(10);
    for (int i = 0; i < times; ++i) {
        char data[100] = {(char)i};
        int64_t const begun = now_ns();
        must(sendto(s, data, sizeof data, 0, (struct sockaddr*)&to, sizeof to) == sizeof data, "sendto");
        ssize_t n = recv(s, data, sizeof data, 0);
        int64_t const ended = now_ns();
        printf("%s %d %lld %lld\n", n == sizeof data && data[0] == i ? "echo" : n < 0 ? strerror(errno) : "wrong", i, (long long)begun, (long long)ended);
        fflush(stdout);
        sleep_ms(3);
    }
}

static void tcp_echo(void) {
    int s = socket(AF_INET, SOCK_STREAM, 0), one = 1;
    struct sockaddr_in own = address("0.0.0.0", 7), from;
    setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    must(bind(s, (struct sockaddr*)&own, sizeof own) == 0, "bind");
    must(listen(s, 5) == 0, "listen");
    for (;;) {
        socklen_t size = sizeof from;
        int c = accept(s, (struct sockaddr*)&from, &size);
        must(c >= 0, "accept");
        printf("accepted %s at %lld\n", inet_ntoa(from.sin_addr), (long long)now_ns());
        fflush(stdout);
        char data[65536];
        long total = 0;
        for (ssize_t n; (n = read(c, data, sizeof data)) > 0; total += n) {
            must(write(c, data, (size_t)n) == n, "write");
        }
        printf("closed after %ld at %lld\n", total, (long long)now_ns());
        fflush(stdout);
        close(c);
    }
}

/// Connects, sends so many octets, reads them back, closes.
static void tcp_ask(char const* server, int port, long octets) {
    sleep_ms(10);
    int s = socket(AF_INET, SOCK_STREAM, 0), one = 1;
    struct sockaddr_in to = address(server, port);
    setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    int64_t const begun = now_ns();
    int const failed = connect(s, (struct sockaddr*)&to, sizeof to);
    int64_t const connected = now_ns();
    printf("%s %lld %lld\n", failed ? strerror(errno) : "connected", (long long)begun, (long long)connected);
    fflush(stdout);
    if (failed) {
        return;
    }
    long sent = 0, got = 0, wrong = 0;
    char data[4096];
    while (got < octets) {
        long const n = octets - sent < (long)sizeof data ? octets - sent : (long)sizeof data;
        for (long i = 0; i < n; ++i) {
            data[i] = (char)octet_of(sent + i);
        }
        must(n == 0 || send(s, data, (size_t)n, 0) == n, "send");
        sent += n;
        ssize_t const back = recv(s, data, sizeof data, sent < octets ? MSG_DONTWAIT : 0);
        must(back > 0 || (back < 0 && errno == EAGAIN), "recv");
        for (ssize_t i = 0; i < back; ++i) {
            wrong += (uint8_t)data[i] != octet_of(got + i);
        }
        got += back > 0 ? back : 0;
    }
    shutdown(s, SHUT_WR);
    ssize_t const end = read(s, data, sizeof data);
    printf("whole %ld wrong %ld end %zd at %lld\n", got, wrong, end, (long long)now_ns());
    fflush(stdout);
    close(s);
}

/// Connects, says three octets, and is gone without a word.
static void tcp_leave(char const* server) {
    sleep_ms(10);
    int s = socket(AF_INET, SOCK_STREAM, 0);
    struct sockaddr_in to = address(server, 7);
    must(connect(s, (struct sockaddr*)&to, sizeof to) == 0, "connect");
    must(send(s, "bye", 3, 0) == 3, "send");
    sleep_ms(20);
    char data[3];
    must(recv(s, data, 3, MSG_WAITALL) == 3, "recv");
    printf("left at %lld\n", (long long)now_ns());
    fflush(stdout);
    _exit(0);
}

int main(int argc, char** argv) {
    if (argc == 2 && strcmp(argv[1], "udp_echo") == 0) {
        udp_echo();
    } else if (argc == 4 && strcmp(argv[1], "udp_ask") == 0) {
        udp_ask(argv[2], atoi(argv[3]));
    } else if (argc == 2 && strcmp(argv[1], "tcp_echo") == 0) {
        tcp_echo();
    } else if (argc == 3 && strcmp(argv[1], "tcp_leave") == 0) {
        tcp_leave(argv[2]);
    } else if (argc == 5 && strcmp(argv[1], "tcp_ask") == 0) {
        tcp_ask(argv[2], atoi(argv[3]), atol(argv[4]));
    }
    return 0;
}
