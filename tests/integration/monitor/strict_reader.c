/* SPDX-FileCopyrightText: 2026 Gridspace contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/*
 * strict_reader DOMAIN: a reader of `rt/weather` over CycloneDDS that asks for what few writers offer: XCDR2, order by
 * the source's clock, and ordered access by topic. Until its standard input ends.
 */
#include "weather.h"

#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

static dds_entity_t made(dds_entity_t entity, const char* what) {
    if (entity < 0) {
        fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
        exit(1);
    }
    return entity;
}

int main(int argc, char** argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: strict_reader DOMAIN\n");
        return 2;
    }
    const dds_domainid_t domain = (dds_domainid_t)atoi(argv[1]);
    made(dds_create_domain(
             domain, "<General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/></Interfaces>"
                     "<AllowMulticast>true</AllowMulticast></General>"),
         "domain");
    const dds_entity_t participant = made(dds_create_participant(domain, NULL, NULL), "participant");
    dds_qos_t* qos = dds_create_qos();
    dds_qset_presentation(qos, DDS_PRESENTATION_TOPIC, false, true);
    const dds_entity_t subscriber = made(dds_create_subscriber(participant, qos, NULL), "subscriber");
    dds_delete_qos(qos);
    const dds_entity_t topic =
        made(dds_create_topic(participant, &station_Weather_desc, "rt/weather", NULL, NULL), "topic");
    qos = dds_create_qos();
    dds_qset_destination_order(qos, DDS_DESTINATIONORDER_BY_SOURCE_TIMESTAMP);
    dds_data_representation_id_t const xcdr2 = DDS_DATA_REPRESENTATION_XCDR2;
    dds_qset_data_representation(qos, 1, &xcdr2);
    made(dds_create_reader(subscriber, topic, qos, NULL), "reader");
    dds_delete_qos(qos);
    while (getchar() != EOF) {
    }
    return 0;
}
