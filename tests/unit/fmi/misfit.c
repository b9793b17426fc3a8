// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A model that does from the time `at` on what its parameter `fault` says. Until then y is the time that it has stepped through.
#include "model.h"

#include <math.h>
#include <stdlib.h>

enum { TIME, AT, Y, LARGEST }; // reals
enum { FAULT };                // integers
enum { NONE, SEGFAULT, ABORT, ENDLESS, FATAL, ERROR_, DISCARD, EARLY, EXIT, TERMINATE, NOT_A_NUMBER, WARNING, STACK };

char const* const model_token = "{0c6b8a36-52a5-4c0a-9a83-5f3f5c1f9a02}";

void model_defaults(Model* m) { m->real[LARGEST] = 1e9; }
void model_outputs(Model* m) { (void)m; }

static volatile int sink;
static int volatile* volatile nowhere;

static int overflow(int depth) {
    int volatile here[1024];
    here[0] = depth;
    return depth == sink - 1 ? 0 : overflow(depth + 1) + here[0]; // sink is 0: without an end
}

Outcome model_step(Model* m, double time, double step, double* reached, bool* terminate, char const** message) {
    if (time + step / 2 < m->real[AT]) {
        m->real[Y] += step;
        return MODEL_OK;
    }
    switch (m->integer[FAULT]) {
    case SEGFAULT:
        *nowhere = 1;
        break;
    case ABORT:
        abort();
    case ENDLESS:
        for (;;) {
            ++sink;
        }
    case FATAL:
        *message = "the solver is beyond repair";
        return MODEL_FATAL;
    case ERROR_:
        *message = "the solver found no solution";
        return MODEL_ERROR;
    case DISCARD:
        if (step > m->real[LARGEST]) {
            m->real[Y] = -1; // a state that must not survive
            *reached = time + m->real[LARGEST];
            return MODEL_DISCARD;
        }
        break;
    case EARLY:
        if (step > m->real[LARGEST]) {
            m->real[Y] += m->real[LARGEST];
            *reached = time + m->real[LARGEST];
            return MODEL_OK;
        }
        break;
    case EXIT:
        exit(0);
    case TERMINATE:
        *terminate = true;
        return MODEL_OK;
    case NOT_A_NUMBER:
        m->real[Y] = NAN;
        return MODEL_OK;
    case WARNING:
        *message = "close to the edge";
        m->real[Y] += step;
        return MODEL_WARNING;
    case STACK:
        sink = overflow(0);
        break;
    default:
        break;
    }
    m->real[Y] += step;
    return MODEL_OK;
}
