/* SPDX-FileCopyrightText: 2026 Gridspace contributors
   SPDX-License-Identifier: Apache-2.0

   What the test programs share. They know nothing of Gridspace: an interface, frames, the clock of the machine. */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <net/if.h>
#include <netpacket/packet.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { SV = 0x88BA, GOOSE = 0x88B8 };

static int64_t now_ns(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

/* A packet socket that is bound to one ethertype of an interface, with stamps. */
static int open_port(char const* interface, int ethertype) {
    int const port = socket(AF_PACKET, SOCK_RAW, htons((uint16_t)ethertype));
    struct sockaddr_ll at = {.sll_family = AF_PACKET,
                             .sll_protocol = htons((uint16_t)ethertype),
                             .sll_ifindex = (int)if_nametoindex(interface)};
    int const on = 1;
    if (port < 0 || bind(port, (struct sockaddr*)&at, sizeof at) != 0 ||
        setsockopt(port, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0) {
        perror(interface);
        exit(1);
    }
    return port;
}

/* The stream of a frame of sampled values by the last octet of its address (33 or 34), its smpCnt, and its stamp; 0
 * without a frame. */
static int receive(int port, int* count, int64_t* stamp_ns) {
    uint8_t frame[1600];
    char control[256];
    struct iovec part = {frame, sizeof frame};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control};
    ssize_t const size = recvmsg(port, &message, 0);
    if (size <= 0)
        return 0;
    struct cmsghdr const* const c = CMSG_FIRSTHDR(&message);
    struct timespec stamp = {0, 0};
    if (c != NULL && c->cmsg_type == SCM_TIMESTAMPNS)
        memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    *stamp_ns = (int64_t)stamp.tv_sec * 1000000000 + stamp.tv_nsec;
    *count = -1;
    for (ssize_t i = 22; i + 3 < size; ++i) { /* smpCnt: tag 82, two octets */
        if (frame[i] == 0x82 && frame[i + 1] == 2) {
            *count = frame[i + 2] << 8 | frame[i + 3];
            break;
        }
    }
    return frame[5];
}

/* A frame that carries three numbers. */
static void send_numbers(int port, char const* interface, int ethertype, uint8_t last_octet, int64_t a, int64_t b,
                         int64_t c) {
    struct {
        uint8_t to[6], from[6];
        uint16_t ethertype, app_id, length, reserved[2];
        int64_t numbers[3];
    } __attribute__((packed)) frame = {{1, 0x0C, 0xCD, 4, 1, last_octet},
                                       {0},
                                       htons((uint16_t)ethertype),
                                       htons(0x4100),
                                       htons(sizeof frame - 14),
                                       {0, 0},
                                       {a, b, c}};
    struct ifreq request;
    memset(&request, 0, sizeof request);
    strncpy(request.ifr_name, interface, IFNAMSIZ - 1);
    ioctl(port, SIOCGIFHWADDR, &request);
    memcpy(frame.from, request.ifr_hwaddr.sa_data, 6);
    if (send(port, &frame, sizeof frame, 0) != (ssize_t)sizeof frame) {
        perror("send");
        exit(1);
    }
}
