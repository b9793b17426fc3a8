// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The only program of a virtual machine: a line differential relay, which is also the machine's first process. Sampled
// values of both ends of TL-2 in (IEC 61850-9-2), a GOOSE trip out (IEC 61850-8-1), on the machine's first network
// interface. It knows nothing of Gridspace but the streams that configs/scenarios/protection.yaml declares.
#define _GNU_SOURCE // ppoll
#include <arpa/inet.h>
#include <endian.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <math.h>
#include <net/if.h>
#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/reboot.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static char const kFrom[] = "GS_TL2_MU21", kTo[] = "GS_TL2_MU22";
static char const kControlBlock[] = "IED2LD0/LLN0$GO$Trip", kDataSet[] = "IED2LD0/LLN0$TRIP2";
static uint8_t const kTripAddress[6] = {0x01, 0x0c, 0xcd, 0x01, 0x00, 0x02};
enum { kTripAppId = 0x8002, kSv = 0x88ba, kGoose = 0x88b8, kVlan = 0x8100, kPriority = 4 };
enum { kRate = 4800, kCycle = kRate / 60, kPickupA = 30, kBridged = 4, kSteadyMs = 10, kLiveMs = 200 };

static void give_up(char const* what) {
    printf("relay: %s: %s\n", what, strerror(errno));
    if (getpid() == 1) {
        reboot(RB_AUTOBOOT); // with -no-reboot the end of the machine
    }
    exit(1);
}

// The kernel's drivers, which the image has in the order in which they need each other.
static void load_modules(void) {
    for (int n = 0;; ++n) {
        char name[32];
        snprintf(name, sizeof name, "/modules/%02d.ko", n);
        int const file = open(name, O_RDONLY | O_CLOEXEC);
        if (file < 0) {
            return;
        }
        if (syscall(SYS_finit_module, file, "", 0) != 0) {
            give_up(name);
        }
        close(file);
    }
}

static int open_port(char const* interface, uint8_t own[6]) {
    int const port = socket(AF_PACKET, SOCK_RAW, htons(ETH_P_ALL));
    struct ifreq request = {0};
    strncpy(request.ifr_name, interface, sizeof request.ifr_name - 1);
    if (port < 0 || ioctl(port, SIOCGIFINDEX, &request) != 0) {
        give_up(interface);
    }
    struct sockaddr_ll const at = {
        .sll_family = AF_PACKET, .sll_protocol = htons(ETH_P_ALL), .sll_ifindex = request.ifr_ifindex};
    ioctl(port, SIOCGIFHWADDR, &request);
    memcpy(own, request.ifr_hwaddr.sa_data, 6);
    ioctl(port, SIOCGIFFLAGS, &request);
    bool const is_up = (request.ifr_flags & IFF_UP) != 0; // in a machine of its own nobody else does it
    request.ifr_flags |= IFF_UP;
    int const yes = 1, room = 4 << 20;
    if ((!is_up && ioctl(port, SIOCSIFFLAGS, &request) != 0) ||
        bind(port, (struct sockaddr const*)&at, sizeof at) != 0) {
        give_up(interface);
    }
    struct packet_mreq const groups = {.mr_ifindex = at.sll_ifindex,
                                       .mr_type = PACKET_MR_ALLMULTI}; // or the network card drops them
    setsockopt(port, SOL_PACKET, PACKET_ADD_MEMBERSHIP, &groups, sizeof groups);
    setsockopt(port, SOL_SOCKET, SO_RCVBUFFORCE, &room, sizeof room);
    setsockopt(port, SOL_PACKET, PACKET_AUXDATA, &yes, sizeof yes); // has the tag, which the kernel takes off
    do {
        usleep(10000);
        ioctl(port, SIOCGIFFLAGS, &request);
    } while ((request.ifr_flags & IFF_RUNNING) == 0);
    return port;
}

// Sampled values: an element of BER (tag, length, content), in what is left of its parent.
struct Span {
    uint8_t const* at;
    size_t size;
};

static bool next(struct Span* rest, uint8_t* tag, struct Span* content) {
    if (rest->size < 2) {
        return false;
    }
    size_t head = 2, size = rest->at[1];
    if (size >= 0x80) {
        size_t const octets = size & 0x7f;
        size = 0;
        for (size_t n = 0; n < octets && head < rest->size; ++n) {
            size = size << 8 | rest->at[head++];
        }
    }
    if (head + size > rest->size) {
        return false;
    }
    *tag = rest->at[0];
    *content = (struct Span){rest->at + head, size};
    *rest = (struct Span){rest->at + head + size, rest->size - head - size};
    return true;
}

static bool find(struct Span in, uint8_t wanted, struct Span* out) {
    uint8_t tag = 0;
    while (next(&in, &tag, out)) {
        if (tag == wanted) {
            return true;
        }
    }
    return false;
}

// One end of the line: the sums of the squares of three phases over the last cycle.
struct End {
    char const* name;
    double square[kCycle][3], sum[3];
    int last;   // sample counter, -1: none yet
    int filled; // samples in a row
    long holes;
};

static void push(struct End* end, float const sample[3]) {
    double* const old = end->square[end->filled++ % kCycle];
    for (int p = 0; p < 3; ++p) {
        double const square = (double)sample[p] * sample[p];
        end->sum[p] += square - old[p];
        old[p] = square;
    }
}

static void add(struct End* end, int count, uint8_t const* octets) {
    float sample[3];
    for (int p = 0; p < 3; ++p) {
        uint32_t bits = 0;
        memcpy(&bits, octets + 4 * p, sizeof bits);
        bits = be32toh(bits);
        memcpy(&sample[p], &bits, sizeof bits);
    }
    int missing = end->last < 0 ? 0 : (count - end->last - 1 + kRate) % kRate;
    end->last = count;
    end->holes += missing > 0;
    if (missing > kBridged) { // a hole: nothing is decided until a cycle is whole again
        memset(end->square, 0, sizeof end->square);
        memset(end->sum, 0, sizeof end->sum);
        end->filled = missing = 0;
    }
    for (; missing >= 0; --missing) {
        push(end, sample);
    }
}

// The counters may be some samples apart: an RMS over a cycle changes little meanwhile.
static double difference_a(struct End const* a, struct End const* b) {
    double largest = 0;
    for (int p = 0; p < 3 && a->filled >= kCycle && b->filled >= kCycle; ++p) {
        largest = fmax(largest, fabs(sqrt(fmax(a->sum[p], 0) / kCycle) - sqrt(fmax(b->sum[p], 0) / kCycle)));
    }
    return largest;
}

static uint8_t* put(uint8_t* at, uint8_t tag, void const* content, size_t size) {
    *at++ = tag;
    *at++ = (uint8_t)size;
    memcpy(at, content, size);
    return at + size;
}

static uint8_t* put_number(uint8_t* at, uint8_t tag, uint32_t value) {
    uint8_t const octets[5] = {0, (uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                               (uint8_t)value};
    int first = 0; // an INTEGER is as short as it goes, and its first bit is the sign
    while (first < 4 && octets[first] == 0 && octets[first + 1] < 0x80) {
        ++first;
    }
    return put(at, tag, octets + first, (size_t)(5 - first));
}

struct Trip {
    bool value;
    uint32_t st_num, sq_num;
    struct timespec changed;
    double interval_s, due_s;
};

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void send_trip(int port, uint8_t const own[6], struct Trip* trip) {
    uint8_t const no = 0, one = 1, value = trip->value ? 0xff : 0;
    uint64_t const stamp = htobe64((uint64_t)trip->changed.tv_sec << 32 |
                                   (((uint64_t)trip->changed.tv_nsec << 24) / 1000000000U) << 8 | 10);
    uint8_t message[256], inside[4], *at = message;
    at = put(at, 0x80, kControlBlock, sizeof kControlBlock - 1);
    at = put_number(at, 0x81, kLiveMs);
    at = put(at, 0x82, kDataSet, sizeof kDataSet - 1);
    at = put(at, 0x84, &stamp, sizeof stamp);
    at = put_number(at, 0x85, trip->st_num);
    at = put_number(at, 0x86, trip->sq_num++);
    at = put(at, 0x87, &no, 1);
    at = put_number(at, 0x88, 1);
    at = put(at, 0x89, &no, 1);
    at = put(at, 0x8a, &one, 1);
    at = put(at, 0xab, inside, (size_t)(put(inside, 0x83, &value, 1) - inside));
    uint16_t const size = (uint16_t)(at - message); // below 128: lengths of one octet
    uint16_t const head[] = {
        htons(kVlan), htons(kPriority << 13), htons(kGoose), htons(kTripAppId), htons((uint16_t)(size + 10)), 0, 0};
    uint8_t frame[512];
    memcpy(frame, kTripAddress, 6);
    memcpy(frame + 6, own, 6);
    memcpy(frame + 12, head, sizeof head);
    uint8_t* const end = put(frame + 12 + sizeof head, 0x61, message, size);
    if (send(port, frame, (size_t)(end - frame), 0) < 0) {
        give_up("sending");
    }
    trip->due_s = now_s() + trip->interval_s;
    trip->interval_s = fmin(2 * trip->interval_s, 1e-3 * kSteadyMs);
}

// The end that the frame's sample was added to. One sample to a frame, as the streams are declared.
static struct End* on_frame(struct Span frame, struct End ends[2]) {
    struct Span rest = {frame.at + 22, frame.size - 22}, part, name, count,
                data; // behind the addresses, type, APPID, length
    if (frame.size < 22 || (frame.at[12] << 8 | frame.at[13]) != kSv || !find(rest, 0x60, &part) ||
        !find(part, 0xa2, &part) || !find(part, 0x30, &part) || !find(part, 0x80, &name) || !find(part, 0x82, &count) ||
        !find(part, 0x87, &data) || count.size != 2 || data.size < 12) {
        return NULL;
    }
    for (int e = 0; e < 2; ++e) {
        if (name.size == strlen(ends[e].name) && memcmp(name.at, ends[e].name, name.size) == 0) {
            add(&ends[e], count.at[0] << 8 | count.at[1], data.at);
            return &ends[e];
        }
    }
    return NULL;
}

int main(int count, char** words) {
    static struct End ends[2] = {{.name = kFrom, .last = -1}, {.name = kTo, .last = -1}};
    setvbuf(stdout, NULL, _IOLBF, 0);
    load_modules();
    uint8_t own[6];
    int const port = open_port(count > 1 ? words[1] : "eth0", own);
    struct Trip trip = {.st_num = 1, .interval_s = 1e-3 * kSteadyMs, .due_s = now_s()};
    clock_gettime(CLOCK_REALTIME, &trip.changed);
    printf("relay: ready\n");
    bool heard = false;
    while (true) {
        double const left_s = trip.due_s - now_s();
        if (left_s <= 0) {
            send_trip(port, own, &trip);
            continue;
        }
        uint8_t octets[2048], control[256];
        struct iovec part = {octets, sizeof octets};
        struct msghdr message = {
            .msg_iov = &part, .msg_iovlen = 1, .msg_control = control, .msg_controllen = sizeof control};
        ssize_t const size = recvmsg(port, &message, MSG_DONTWAIT);
        if (size < 0) {
            struct timespec const patience = {0, (long)(1e9 * left_s)};
            struct pollfd wait = {port, POLLIN, 0};
            ppoll(&wait, 1, &patience, NULL);
            continue;
        }
        struct End const* const end = on_frame((struct Span){octets, (size_t)size}, ends);
        if (end == NULL) {
            continue;
        }
        struct cmsghdr const* const note = CMSG_FIRSTHDR(&message);
        if (!heard && note != NULL && note->cmsg_type == PACKET_AUXDATA) {
            struct tpacket_auxdata tag;
            memcpy(&tag, CMSG_DATA(note), sizeof tag);
            heard = true;
            printf("relay: hears %s, priority %d\n", end->name,
                   (tag.tp_status & TP_STATUS_VLAN_VALID) != 0 ? tag.tp_vlan_tci >> 13 : -1);
        }
        if (!trip.value && difference_a(&ends[0], &ends[1]) > kPickupA) {
            trip = (struct Trip){.value = true, .st_num = trip.st_num + 1, .interval_s = 1e-3};
            clock_gettime(CLOCK_REALTIME, &trip.changed);
            send_trip(port, own, &trip);
            printf("relay: trip at sample %d, %.1f A; %ld holes in the samples before\n", end->last,
                   difference_a(&ends[0], &ends[1]), ends[0].holes + ends[1].holes);
        }
    }
}
