// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a model is to the functions of FMI in fmi2.c and fmi3.c: its variables, and three functions. The value reference
// of a variable is its place in the array of its type.
#ifndef GRIDSPACE_EXAMPLE_MODEL_H
#define GRIDSPACE_EXAMPLE_MODEL_H

#include <stdbool.h>

#define REALS 8
#define INTEGERS 4
#define BOOLEANS 4
#define STRINGS 2

typedef struct {
    double real[REALS];
    int integer[INTEGERS];
    bool boolean[BOOLEANS];
    char string[STRINGS][64];
} Model;

typedef enum {
    MODEL_OK,
    MODEL_WARNING,
    MODEL_DISCARD,
    MODEL_ERROR,
    MODEL_FATAL
} Outcome; // as fmi2Status and fmi3Status

extern char const* const model_token; // GUID of FMI 2.0, instantiationToken of FMI 3.0

void model_defaults(Model* model); // the start values of the description
void model_outputs(Model* model);  // outputs from states and inputs
/// From `time` to `time + step`. Who comes less far says so in `reached`; `terminate`: no further step is wanted;
/// `message`: why not, a text that stays.
Outcome model_step(Model* model, double time, double step, double* reached, bool* terminate, char const** message);

#endif
