/* SPDX-FileCopyrightText: 2026 Gridspace contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strange_writers DOMAIN: writers over CycloneDDS that not every reader hears, each on a topic of its own: `xcdr2` in
 * another representation, `parted` in two partitions, `owned` with exclusive ownership, `patient` with a latency
 * budget, and `kept`, of a participant without a name, which writes once, for those who come late too. Says "written"
 * then. Until its standard input ends.
 */
#include "weather.h"

#include <dds/dds.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>

static dds_entity_t made(dds_entity_t entity, const char* what) {
    if (entity < 0) {
        fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
        exit(1);
    }
    return entity;
}

static dds_entity_t writer(dds_entity_t participant, const char* name, dds_qos_t* qos) {
    dds_data_representation_id_t const xcdr1 = DDS_DATA_REPRESENTATION_XCDR1;
    dds_data_representation_id_t* representations = NULL;
    uint32_t count = 0;
    if (!dds_qget_data_representation(qos, &count, &representations) || count == 0) {
        dds_qset_data_representation(qos, 1, &xcdr1);
    }
    dds_free(representations);
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    const dds_entity_t topic = made(dds_create_topic(participant, &station_Weather_desc, name, NULL, NULL), name);
    const dds_entity_t out = made(dds_create_writer(participant, topic, qos, NULL), name);
    dds_delete_qos(qos);
    return out;
}

int main(int argc, char** argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: strange_writers DOMAIN\n");
        return 2;
    }
    const dds_domainid_t domain = (dds_domainid_t)atoi(argv[1]);
    made(dds_create_domain(
             domain, "<General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/></Interfaces>"
                     "<AllowMulticast>true</AllowMulticast></General>"),
         "domain");
    dds_qos_t* qos = dds_create_qos();
    dds_qset_entity_name(qos, "stranger");
    const dds_entity_t participant = made(dds_create_participant(domain, qos, NULL), "participant");
    dds_delete_qos(qos);

    dds_entity_t writers[4];
    qos = dds_create_qos();
    dds_data_representation_id_t const xcdr2 = DDS_DATA_REPRESENTATION_XCDR2;
    dds_qset_data_representation(qos, 1, &xcdr2);
    writers[0] = writer(participant, "xcdr2", qos);
    qos = dds_create_qos();
    const char* partitions[] = {"plantA", "plantB"};
    dds_qset_partition(qos, 2, partitions);
    writers[1] = writer(participant, "parted", qos);
    qos = dds_create_qos();
    dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
    writers[2] = writer(participant, "owned", qos);
    qos = dds_create_qos();
    dds_qset_latency_budget(qos, DDS_SECS(5));
    writers[3] = writer(participant, "patient", qos);
    qos = dds_create_qos();
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    const dds_entity_t kept = writer(made(dds_create_participant(domain, NULL, NULL), "participant"), "kept", qos);

    station_Weather sample = {.place = "roof", .celsius = 21.5, .trend = -3};
    dds_write(kept, &sample);
    puts("written");
    fflush(stdout);
    struct pollfd input = {0, POLLIN, 0};
    do {
        for (int i = 0; i < 4; ++i) {
            dds_write(writers[i], &sample);
        }
    } while (poll(&input, 1, 50) == 0);
    return 0;
}
