/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   epoll with a timerfd of 10 ms: tells by a frame how many came since the last time. */
#include "frames.h"
#include <sys/epoll.h>
#include <sys/timerfd.h>

int main(int argc, char** argv) {
    int const port = open_port(argv[argc - 1], SV), out = open_port(argv[argc - 1], GOOSE);
    int const timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK), loop = epoll_create1(0);
    struct itimerspec const period = {{0, 10000000}, {0, 10000000}};
    timerfd_settime(timer, 0, &period, NULL);
    struct epoll_event events[2] = {{EPOLLIN, {.fd = port}}, {EPOLLIN, {.fd = timer}}};
    epoll_ctl(loop, EPOLL_CTL_ADD, port, &events[0]);
    epoll_ctl(loop, EPOLL_CTL_ADD, timer, &events[1]);
    for (int64_t frames = 0, rung = 0;;) {
        int const ready = epoll_wait(loop, events, 2, -1);
        for (int i = 0; i < ready; ++i) {
            int count;
            int64_t stamp_ns;
            uint64_t times;
            if (events[i].data.fd == port) {
                frames += receive(port, &count, &stamp_ns) != 0;
            } else if (read(timer, &times, sizeof times) == sizeof times) {
                rung += (int64_t)times;
                send_numbers(out, argv[1], GOOSE, 3, rung, now_ns(CLOCK_MONOTONIC), frames);
                frames = 0;
            }
        }
    }
}
