// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of FMI 3.0 for co-simulation that an importer needs, around a model. Integers are Int32.
#include "model.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef void (*LogMessage)(void* environment, int status, char const* category, char const* message);

typedef struct {
    Model model;
    LogMessage log;
    void* environment;
    bool may_return_early;
} Instance;

EXPORT char const* fmi3GetVersion(void) { return "3.0"; }

EXPORT void* fmi3InstantiateCoSimulation(char const* name, char const* token, char const* resources, bool visible, bool logging,
                                         bool event_mode, bool early_return, uint32_t const* intermediate, size_t count,
                                         void* environment, LogMessage log, void* update) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)intermediate, (void)count, (void)update;
    if (strcmp(token, model_token) != 0) {
        return NULL;
    }
    Instance* const made = calloc(1, sizeof *made);
    if (made != NULL) {
        made->log = log;
        made->environment = environment;
        made->may_return_early = early_return;
        model_defaults(&made->model);
    }
    return made;
}
EXPORT void fmi3FreeInstance(void* c) { free(c); }

EXPORT int fmi3EnterInitializationMode(void* c, bool has_tolerance, double tolerance, double start, bool has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Instance*)c)->model.real[0] = start;
    return MODEL_OK;
}
EXPORT int fmi3ExitInitializationMode(void* c) { model_outputs(&((Instance*)c)->model); return MODEL_OK; }
EXPORT int fmi3Terminate(void* c) { (void)c; return MODEL_OK; }
EXPORT int fmi3Reset(void* c) {
    Instance* const i = c;
    memset(&i->model, 0, sizeof i->model);
    model_defaults(&i->model);
    return MODEL_OK;
}

#define ACCESS(NAME, TYPE, FIELD, SIZE)                                                                                  \
    EXPORT int fmi3Get##NAME(void* c, uint32_t const* reference, size_t count, TYPE* value, size_t values) {             \
        Instance* const i = c;                                                                                           \
        model_outputs(&i->model);                                                                                        \
        for (size_t n = 0; n < count; ++n) {                                                                             \
            if (values != count || reference[n] >= SIZE) {                                                               \
                return MODEL_ERROR;                                                                                      \
            }                                                                                                            \
            value[n] = i->model.FIELD[reference[n]];                                                                     \
        }                                                                                                                \
        return MODEL_OK;                                                                                                 \
    }
#define CHANGE(NAME, TYPE, FIELD, SIZE)                                                                                  \
    EXPORT int fmi3Set##NAME(void* c, uint32_t const* reference, size_t count, TYPE const* value, size_t values) {       \
        for (size_t n = 0; n < count; ++n) {                                                                             \
            if (values != count || reference[n] >= SIZE) {                                                               \
                return MODEL_ERROR;                                                                                      \
            }                                                                                                            \
            ((Instance*)c)->model.FIELD[reference[n]] = value[n];                                                        \
        }                                                                                                                \
        return MODEL_OK;                                                                                                 \
    }
ACCESS(Float64, double, real, REALS)
ACCESS(Int32, int32_t, integer, INTEGERS)
ACCESS(Boolean, bool, boolean, BOOLEANS)
ACCESS(String, char const*, string, STRINGS)
CHANGE(Float64, double, real, REALS)
CHANGE(Int32, int32_t, integer, INTEGERS)
CHANGE(Boolean, bool, boolean, BOOLEANS)
EXPORT int fmi3SetString(void* c, uint32_t const* reference, size_t count, char const* const* value, size_t values) {
    for (size_t n = 0; n < count; ++n) {
        if (values != count || reference[n] >= STRINGS) {
            return MODEL_ERROR;
        }
        strncpy(((Instance*)c)->model.string[reference[n]], value[n], sizeof((Model*)0)->string[0] - 1);
    }
    return MODEL_OK;
}

// Types that no variable of ours has. An importer asks for the functions all the same.
#define NONE(NAME, TYPE)                                                                                                 \
    EXPORT int fmi3Get##NAME(void* c, uint32_t const* reference, size_t count, TYPE* value, size_t values) {             \
        (void)c, (void)reference, (void)count, (void)value, (void)values;                                                \
        return MODEL_ERROR;                                                                                              \
    }                                                                                                                    \
    EXPORT int fmi3Set##NAME(void* c, uint32_t const* reference, size_t count, TYPE const* value, size_t values) {       \
        (void)c, (void)reference, (void)count, (void)value, (void)values;                                                \
        return MODEL_ERROR;                                                                                              \
    }
NONE(Float32, float)
NONE(Int8, int8_t)
NONE(UInt8, uint8_t)
NONE(Int16, int16_t)
NONE(UInt16, uint16_t)
NONE(UInt32, uint32_t)
NONE(Int64, int64_t)
NONE(UInt64, uint64_t)

EXPORT int fmi3DoStep(void* c, double time, double step, bool no_rollback, bool* needs_event, bool* terminate, bool* early,
                      double* reached) {
    (void)no_rollback;
    Instance* const i = c;
    char const* message = NULL;
    *needs_event = *terminate = *early = false;
    *reached = time + step;
    Outcome const outcome = model_step(&i->model, time, step, reached, terminate, &message);
    if (message != NULL) {
        i->log(i->environment, outcome, "model", message);
    }
    *early = *reached < time + step;
    return outcome == MODEL_OK && *early && !i->may_return_early ? MODEL_DISCARD : outcome;
}

EXPORT int fmi3GetFMUState(void* c, void** state) {
    if (*state == NULL) {
        *state = malloc(sizeof(Model));
    }
    return *state == NULL ? MODEL_ERROR : (memcpy(*state, &((Instance*)c)->model, sizeof(Model)), MODEL_OK);
}
EXPORT int fmi3SetFMUState(void* c, void* state) {
    memcpy(&((Instance*)c)->model, state, sizeof(Model));
    return MODEL_OK;
}
EXPORT int fmi3FreeFMUState(void* c, void** state) {
    (void)c;
    free(*state);
    *state = NULL;
    return MODEL_OK;
}
EXPORT int fmi3SerializedFMUStateSize(void* c, void* state, size_t* size) {
    (void)c, (void)state;
    *size = sizeof(Model);
    return MODEL_OK;
}
EXPORT int fmi3SerializeFMUState(void* c, void* state, uint8_t* octets, size_t size) {
    (void)c;
    return size < sizeof(Model) ? MODEL_ERROR : (memcpy(octets, state, sizeof(Model)), MODEL_OK);
}
EXPORT int fmi3DeserializeFMUState(void* c, uint8_t const* octets, size_t size, void** state) {
    if (size != sizeof(Model) || fmi3GetFMUState(c, state) != MODEL_OK) {
        return MODEL_ERROR;
    }
    memcpy(*state, octets, size);
    return MODEL_OK;
}
