/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   Polls with a timeout of 1 ms, writes down each frame with its stamp and the clock, and each millisecond without any. */
#include "frames.h"
#include <poll.h>

int main(int argc, char** argv) {
    int const port = open_port(argv[argc - 1], GOOSE);
    setvbuf(stdout, NULL, _IOLBF, 0);
    for (;;) {
        struct pollfd wait = {port, POLLIN, 0};
        int count;
        int64_t stamp_ns;
        if (poll(&wait, 1, 1) == 0) {
            printf("nothing until %lld\n", (long long)now_ns(CLOCK_MONOTONIC));
            continue;
        }
        int const stream = receive(port, &count, &stamp_ns);
        printf("%d %d at %lld, %lld later\n", stream, count, (long long)stamp_ns, (long long)(now_ns(CLOCK_REALTIME) - stamp_ns));
    }
}
