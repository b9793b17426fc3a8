// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// An EV agent of your own: asks every six minutes for the battery current that its EV needs, Eq. (1) and (2), as
// gridspace-ev does.
#include "bus_gateway.h"
#include "ev_charging.h"
#include "lockstep_member.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    char const* ev;
    int64_t due_ns; // simulated time of the next request
    bool seen;
    double v_pu, soc_percent; // the newest that was measured until then
} agent;

static void on_measurement(void* user, void const* sample, int64_t source_ns) {
    (void)source_ns;
    BusMeasurement const* bus = sample;
    agent* a = user;
    for (uint32_t i = 0; i < bus->evs._length && bus->time_ns <= a->due_ns; ++i) {
        if (strcmp(bus->evs._buffer[i].ev, a->ev) == 0) {
            a->seen = true;
            a->v_pu = bus->v_pu;
            a->soc_percent = bus->evs._buffer[i].soc_percent;
        }
    }
}

// Eq. (1): I = (SoC target - SoC) x capacity / (time x battery voltage); Eq. (2): at most the rated current.
static double requested_current_a(double soc_percent, double target_percent, double capacity_kwh, double battery_v,
                                  double rated_a, double hours_left) {
    double const missing = (target_percent - soc_percent) / 100;
    double const hours = hours_left < 0.1 ? 0.1 : hours_left;
    if (!(missing > 0)) {
        return 0;
    }
    double const current = missing * capacity_kwh * 1e3 / (hours * battery_v);
    return current < rated_a ? current : rated_a;
}

int main(int argc, char** argv) {
    if (argc != 4) {
        fprintf(stderr, "usage: %s EV CAPACITY_KWH REQUESTED_H   (started by `gridspace run`)\n", argv[0]);
        return 2;
    }
    agent a = {.ev = argv[1]};
    double const capacity_kwh = atof(argv[2]), requested_h = atof(argv[3]);
    int64_t const period_ns = INT64_C(360) * 1000000000, tick_ns = gs_environment_ns("GRIDSPACE_TICK_S");

    gs_member* m = gs_join();
    gs_reader(m, "bus_measurements", &BusMeasurement_desc, on_measurement, &a);
    gs_writer* requests = gs_writer_of(m, "requests", &ChargingRequest_desc);
    gs_start(m);

    gs_tick tick;
    while (gs_next(m, &tick)) {
        if (a.due_ns <= tick.time_ns) {
            if (a.seen) { // not so when it was restarted: then it asks from the next period on
                double const hours_left = requested_h - (double)a.due_ns / 1e9 / 3600;
                ChargingRequest request = {
                    .time_ns = a.due_ns, .v_pu = a.v_pu, .soc_percent = a.soc_percent, .period_s = 360};
                snprintf(request.ev, sizeof request.ev, "%s", a.ev);
                request.current_a = requested_current_a(a.soc_percent, 80, capacity_kwh, 360, 15, hours_left);
                gs_write(m, requests, &request, a.due_ns);
            }
            while (a.due_ns <= tick.time_ns) {
                a.due_ns += period_ns;
            }
        }
        gs_done(m, &tick, (uint64_t)((a.due_ns + tick_ns - 1) / tick_ns));
    }
    gs_leave(m);
    return 0;
}
