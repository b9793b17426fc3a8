// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A Modbus/TCP server and client, as libmodbus wants them: `modbus_ends serve`, `modbus_ends ask ADDRESS TIMES`.
#include <errno.h>
#include <modbus/modbus.h>
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

static int serve(void) {
    modbus_t* m = modbus_new_tcp("0.0.0.0", 502);
    modbus_mapping_t* registers = modbus_mapping_new(0, 0, 16, 16);
    int listener = modbus_tcp_listen(m, 1);
    if (listener < 0) {
        printf("listen: %s\n", modbus_strerror(errno));
        return 1;
    }
    for (;;) {
        modbus_tcp_accept(m, &listener);
        uint8_t query[MODBUS_TCP_MAX_ADU_LENGTH];
        for (int n; (n = modbus_receive(m, query)) >= 0;) {
            registers->tab_input_registers[0] = (uint16_t)(now_ns() / 1000000); // ms since the start
            modbus_reply(m, query, n, registers);
        }
        modbus_close(m);
    }
}

static int ask(char const* server, int times) {
    usleep(20000);
    modbus_t* m = modbus_new_tcp(server, 502);
    if (modbus_connect(m) != 0) {
        printf("connect: %s\n", modbus_strerror(errno));
        return 1;
    }
    for (int i = 0; i < times; ++i) {
        uint16_t value = 0, back = 0;
        int64_t const begun = now_ns();
        int const written = modbus_write_register(m, 3, (uint16_t)(100 + i));
        int const read = modbus_read_registers(m, 3, 1, &back);
        int const input = modbus_read_input_registers(m, 0, 1, &value);
        printf("%d %d %d back %u at %u took %lld\n", written, read, input, back, value, (long long)(now_ns() - begun));
        fflush(stdout);
        usleep(50000);
    }
    modbus_close(m);
    return 0;
}

int main(int argc, char** argv) {
    return argc == 4 && strcmp(argv[1], "ask") == 0 ? ask(argv[2], atoi(argv[3])) : serve();
}
