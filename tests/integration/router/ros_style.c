/* SPDX-FileCopyrightText: 2026 Gridspace contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Somebody else's programs on somebody else's DDS: topics named as ROS 2 does, over CycloneDDS.
 *   ros_style talk DOMAIN TOPIC...         writes "TOPIC N" on each, N = 0, 1, 2 … every 20 ms, until it is ended
 *   ros_style listen DOMAIN TOPIC...       prints what it hears on any of them
 */
#include "ros_style.h"

#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 8
static const char* const kLoopback =
    "<General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/></Interfaces>"
    "<AllowMulticast>true</AllowMulticast></General>";

static dds_entity_t made(dds_entity_t entity, const char* what) {
    if (entity < 0) {
        fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
        exit(1);
    }
    return entity;
}

int main(int argc, char** argv) {
    if (argc < 4 || argc - 3 > MOST) {
        fprintf(stderr, "usage: ros_style talk|listen DOMAIN TOPIC...\n");
        return 2;
    }
    const int talks = strcmp(argv[1], "talk") == 0, topics = argc - 3;
    const dds_domainid_t domain = (dds_domainid_t)atoi(argv[2]);
    made(dds_create_domain(domain, kLoopback), "domain");
    dds_qos_t* qos = dds_create_qos(); /* ROS 2's default, but for its history of 10: here who is late misses nothing */
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1000);
    dds_qset_userdata(qos, "enclave=/;", 10);
    const dds_entity_t participant = made(dds_create_participant(domain, qos, NULL), "participant");
    dds_entity_t ends[MOST];
    for (int i = 0; i < topics; ++i) {
        const dds_entity_t topic =
            made(dds_create_topic(participant, &std_msgs_msg_dds__String__desc, argv[3 + i], NULL, NULL), argv[3 + i]);
        ends[i] = made(talks ? dds_create_writer(participant, topic, qos, NULL)
                             : dds_create_reader(participant, topic, qos, NULL),
                       "endpoint");
    }
    dds_delete_qos(qos);
    for (unsigned n = 0;; ++n) {
        for (int i = 0; i < topics; ++i) {
            if (talks) {
                char text[256];
                snprintf(text, sizeof text, "%s %u", argv[3 + i], n);
                std_msgs_msg_dds__String_ sample = {text};
                made(dds_write(ends[i], &sample), "write");
                continue;
            }
            void* samples[16] = {0};
            dds_sample_info_t info[16];
            const int got = made(dds_take(ends[i], samples, info, 16, 16), "take");
            for (int k = 0; k < got; ++k) {
                if (info[k].valid_data) {
                    printf("%s\n", ((std_msgs_msg_dds__String_*)samples[k])->data);
                }
            }
            if (got > 0) {
                dds_return_loan(ends[i], samples, got);
                fflush(stdout);
            }
        }
        dds_sleepfor(DDS_MSECS(talks ? 20 : 5));
    }
}
