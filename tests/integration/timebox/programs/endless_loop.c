/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   Sleeps for 50 ms, and then computes without an end and without a call. */
#include <time.h>

int main(void) {
    struct timespec const while_ns = {0, 50000000};
    volatile unsigned rounds = 0;
    nanosleep(&while_ns, NULL);
    for (;;) ++rounds;
}
