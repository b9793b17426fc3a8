// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A first-order lag, tau y' = k u - y, solved exactly for an input that is held over a step.
#include "model.h"

#include <math.h>

enum { TIME, U, Y, K, TAU };  // reals
enum { STEPS };               // integers
enum { HOLD };                // booleans

char const* const model_token = "{5b0a4c0e-1a53-4f0e-9d6f-6c1a6a7b2f01}";

void model_defaults(Model* m) {
    m->real[K] = 1;
    m->real[TAU] = 10;
}

void model_outputs(Model* m) {
    (void)m; // y is a state
}

Outcome model_step(Model* m, double time, double step, double* reached, bool* terminate, char const** message) {
    (void)terminate;
    (void)reached;
    if (!(m->real[TAU] > 0)) {
        *message = "tau must be positive";
        return MODEL_ERROR;
    }
    if (!m->boolean[HOLD]) {
        double const end = m->real[K] * m->real[U];
        m->real[Y] = end + (m->real[Y] - end) * exp(-step / m->real[TAU]);
    }
    m->real[TIME] = time + step;
    ++m->integer[STEPS];
    return MODEL_OK;
}
