/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   Publishes 4800 frames a second, each with its number and what its clock shows; sleeps to absolute deadlines. */
#include "frames.h"

int main(int argc, char** argv) {
    int const port = open_port(argv[argc - 1], SV);
    for (int64_t k = 1;; ++k) {
        int64_t const ns = k * 1000000000 / 4800;
        struct timespec const at = {ns / 1000000000, ns % 1000000000};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
        send_numbers(port, argv[1], SV, 1, k, now_ns(CLOCK_REALTIME), 0);
    }
}
