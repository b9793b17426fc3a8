// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A charging controller as somebody would write it who has never heard of Gridspace: it reads what is measured at the
// buses, and asks for a current for one vehicle, again and again, by the clock of its machine.
//     charger EV AMPERES UNTIL_PERCENT PERIOD_S
#include "bus_gateway.h"
#include "ev_charging.h"

#include "dds/dds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BATCH = 16 };

static dds_entity_t made(dds_entity_t entity, char const* what) {
    if (entity < 0) {
        fprintf(stderr, "DDS refuses %s: %s\n", what, dds_strretcode(-entity));
        exit(1);
    }
    return entity;
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

int main(int argc, char** argv) {
    if (argc != 5) {
        fprintf(stderr, "usage: %s EV AMPERES UNTIL_PERCENT PERIOD_S\n", argv[0]);
        return 2;
    }
    char const* const ev = argv[1];
    double const amperes = atof(argv[2]), until_percent = atof(argv[3]), period_s = atof(argv[4]);

    dds_entity_t const participant = made(dds_create_participant(DDS_DOMAIN_DEFAULT, NULL, NULL), "a participant");
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, BATCH);
    dds_entity_t const measured =
        made(dds_create_topic(participant, &BusMeasurement_desc, "bus_measurements", NULL, NULL), "a topic");
    dds_entity_t const asked =
        made(dds_create_topic(participant, &ChargingRequest_desc, "requests", NULL, NULL), "a topic");
    dds_entity_t const reader = made(dds_create_reader(participant, measured, qos, NULL), "a reader");
    dds_entity_t const writer = made(dds_create_writer(participant, asked, qos, NULL), "a writer");
    dds_delete_qos(qos);
    dds_entity_t const waitset = made(dds_create_waitset(participant), "a waitset");
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waitset, reader, 0);

    BusMeasurement* const room = calloc(BATCH, sizeof *room);
    void* samples[BATCH];
    for (int i = 0; i < BATCH; ++i) {
        samples[i] = &room[i];
    }
    double due_s = 0, soc_percent = 0, v_pu = 0;
    bool seen = false;
    while (true) {
        double const left_s = seen ? due_s - now_s() : 3600;
        dds_attach_t ready;
        dds_waitset_wait(waitset, &ready, 1, left_s > 0 ? (dds_duration_t)(left_s * 1e9) : 0);
        dds_sample_info_t info[BATCH];
        for (int n; (n = dds_take(reader, samples, info, BATCH, BATCH)) > 0;) {
            for (int i = 0; i < n; ++i) {
                for (uint32_t k = 0; info[i].valid_data && k < room[i].evs._length; ++k) {
                    if (strcmp(room[i].evs._buffer[k].ev, ev) == 0) {
                        soc_percent = room[i].evs._buffer[k].soc_percent;
                        v_pu = room[i].v_pu;
                        due_s = seen ? due_s : now_s();
                        seen = true;
                    }
                }
            }
        }
        if (seen && due_s <= now_s()) {
            ChargingRequest request = {.current_a = soc_percent < until_percent ? amperes : 0,
                                       .v_pu = v_pu,
                                       .soc_percent = soc_percent,
                                       .period_s = period_s};
            snprintf(request.ev, sizeof request.ev, "%s", ev);
            if (dds_write(writer, &request) != DDS_RETCODE_OK) {
                fprintf(stderr, "a request could not be sent\n");
                return 1;
            }
            printf("%.6f s: %.3f %%, asks for %.1f A\n", now_s(), soc_percent, request.current_a);
            fflush(stdout);
            due_s += period_s;
        }
    }
}
