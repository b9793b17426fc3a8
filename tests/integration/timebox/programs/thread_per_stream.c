/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   A thread for each of two streams, which are told apart by a filter in the kernel; a third one waits at a condition variable until both
   have the same sample, and answers each tenth pair with a frame. */
#include "frames.h"
#include <linux/filter.h>
#include <pthread.h>

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t changed = PTHREAD_COND_INITIALIZER;
static int newest[2] = {-1, -1};
static char const* interface;

static void* follow(void* argument) {
    long const which = (long)argument;
    int const port = socket(AF_PACKET, SOCK_RAW, 0);
    struct sock_filter code[] = {{BPF_LD | BPF_B | BPF_ABS, 0, 0, 5}, {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, (uint32_t)(0x21 + which)}, {BPF_RET | BPF_K, 0, 0, 65535}, {BPF_RET | BPF_K, 0, 0, 0}};
    struct sock_fprog const filter = {4, code};
    struct sockaddr_ll at = {.sll_family = AF_PACKET, .sll_protocol = htons(SV), .sll_ifindex = (int)if_nametoindex(interface)};
    if (setsockopt(port, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0 || bind(port, (struct sockaddr*)&at, sizeof at) != 0) exit(1);
    for (;;) {
        int count;
        int64_t stamp_ns;
        if (receive(port, &count, &stamp_ns) != 0x21 + which) exit(2);
        pthread_mutex_lock(&mutex);
        newest[which] = count;
        pthread_cond_broadcast(&changed);
        pthread_mutex_unlock(&mutex);
    }
    return NULL;
}

int main(int argc, char** argv) {
    interface = argv[argc - 1];
    int const port = open_port(interface, GOOSE);
    pthread_t threads[2];
    for (long i = 0; i < 2; ++i) pthread_create(&threads[i], NULL, follow, (void*)i);
    for (int last = -1;;) {
        pthread_mutex_lock(&mutex);
        while (newest[0] != newest[1] || newest[0] == last) pthread_cond_wait(&changed, &mutex);
        last = newest[0];
        pthread_mutex_unlock(&mutex);
        if (last % 10 == 0) send_numbers(port, interface, GOOSE, 2, last, now_ns(CLOCK_REALTIME), 0);
    }
}
