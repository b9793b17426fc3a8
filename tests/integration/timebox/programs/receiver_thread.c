/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   As stacks for IEC 61850 do: a thread receives with a timeout of the socket, the main loop sleeps a millisecond at a time. */
#include "frames.h"
#include <errno.h>
#include <pthread.h>
#include <sys/time.h>

static int port;
static volatile int rounds;

static void* follow(void* argument) {
    for (;;) {
        uint8_t frame[1600];
        ssize_t const size = recv(port, frame, sizeof frame, 0);
        struct timeval now;
        if (size < 0 && errno != EAGAIN) exit(2);
        gettimeofday(&now, NULL);
        printf("%s %lld us, %d rounds\n", size > 0 ? "frame" : "nothing", (long long)now.tv_sec * 1000000 + now.tv_usec, rounds);
    }
    return argument;
}

int main(int argc, char** argv) {
    struct timeval const patience = {0, 1500};
    struct timespec const millisecond = {0, 1000000};
    pthread_t thread;
    port = open_port(argv[argc - 1], GOOSE);
    setsockopt(port, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setvbuf(stdout, NULL, _IOLBF, 0);
    pthread_create(&thread, NULL, follow, NULL);
    for (;; ++rounds) nanosleep(&millisecond, NULL);
}
