// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of FMI 2.0 for co-simulation, around a model.
#include "model.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef void (*Logger)(void* environment, char const* instance, int status, char const* category, char const* message, ...);
typedef struct {
    Logger logger;
    void* (*allocate)(size_t, size_t);
    void (*release)(void*);
    void (*step_finished)(void*, int);
    void* environment;
} Callbacks;

typedef struct {
    Model model;
    Callbacks const* callbacks;
    double reached;
    bool terminate;
} Instance;

EXPORT char const* fmi2GetTypesPlatform(void) { return "default"; }
EXPORT char const* fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetDebugLogging(void* c, int on, size_t count, char const* const* categories) {
    (void)c, (void)on, (void)count, (void)categories;
    return MODEL_OK;
}

EXPORT void* fmi2Instantiate(char const* name, int type, char const* guid, char const* resources, Callbacks const* callbacks,
                             int visible, int logging) {
    (void)name, (void)resources, (void)visible, (void)logging;
    if (type != 1 || strcmp(guid, model_token) != 0) {
        return NULL;
    }
    Instance* const made = calloc(1, sizeof *made);
    if (made != NULL) {
        made->callbacks = callbacks;
        model_defaults(&made->model);
    }
    return made;
}
EXPORT void fmi2FreeInstance(void* c) { free(c); }

EXPORT int fmi2SetupExperiment(void* c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Instance*)c)->model.real[0] = start;
    return MODEL_OK;
}
EXPORT int fmi2EnterInitializationMode(void* c) { (void)c; return MODEL_OK; }
EXPORT int fmi2ExitInitializationMode(void* c) { model_outputs(&((Instance*)c)->model); return MODEL_OK; }
EXPORT int fmi2Terminate(void* c) { (void)c; return MODEL_OK; }
EXPORT int fmi2Reset(void* c) {
    Instance* const i = c;
    memset(&i->model, 0, sizeof i->model);
    model_defaults(&i->model);
    return MODEL_OK;
}

#define ACCESS(NAME, TYPE, FIELD, SIZE)                                                                    \
    EXPORT int fmi2Get##NAME(void* c, unsigned const* reference, size_t count, TYPE* value) {              \
        Instance* const i = c;                                                                             \
        model_outputs(&i->model);                                                                          \
        for (size_t n = 0; n < count; ++n) {                                                               \
            if (reference[n] >= SIZE) {                                                                    \
                return MODEL_ERROR;                                                                        \
            }                                                                                              \
            value[n] = i->model.FIELD[reference[n]];                                                       \
        }                                                                                                  \
        return MODEL_OK;                                                                                   \
    }
#define CHANGE(NAME, TYPE, FIELD, SIZE)                                                                    \
    EXPORT int fmi2Set##NAME(void* c, unsigned const* reference, size_t count, TYPE const* value) {        \
        for (size_t n = 0; n < count; ++n) {                                                               \
            if (reference[n] >= SIZE) {                                                                    \
                return MODEL_ERROR;                                                                        \
            }                                                                                              \
            ((Instance*)c)->model.FIELD[reference[n]] = value[n];                                          \
        }                                                                                                  \
        return MODEL_OK;                                                                                   \
    }
ACCESS(Real, double, real, REALS)
ACCESS(Integer, int, integer, INTEGERS)
ACCESS(Boolean, int, boolean, BOOLEANS)
ACCESS(String, char const*, string, STRINGS)
CHANGE(Real, double, real, REALS)
CHANGE(Integer, int, integer, INTEGERS)
CHANGE(Boolean, int, boolean, BOOLEANS)
EXPORT int fmi2SetString(void* c, unsigned const* reference, size_t count, char const* const* value) {
    for (size_t n = 0; n < count; ++n) {
        if (reference[n] >= STRINGS) {
            return MODEL_ERROR;
        }
        strncpy(((Instance*)c)->model.string[reference[n]], value[n], sizeof((Model*)0)->string[0] - 1);
    }
    return MODEL_OK;
}

EXPORT int fmi2DoStep(void* c, double time, double step, int no_rollback) {
    (void)no_rollback;
    Instance* const i = c;
    char const* message = NULL;
    i->reached = time + step;
    Outcome const outcome = model_step(&i->model, time, step, &i->reached, &i->terminate, &message);
    if (message != NULL) {
        i->callbacks->logger(i->callbacks->environment, "", outcome, "model", "at %g s: %s", time, message);
    }
    // FMI 2.0 has no other way to say that a step was not finished or is the last.
    return outcome == MODEL_OK && (i->terminate || i->reached < time + step) ? MODEL_DISCARD : outcome;
}
EXPORT int fmi2CancelStep(void* c) { (void)c; return MODEL_ERROR; }
EXPORT int fmi2GetRealStatus(void* c, int kind, double* value) {
    *value = ((Instance*)c)->reached;
    return kind == 2 ? MODEL_OK : MODEL_DISCARD;
}
EXPORT int fmi2GetBooleanStatus(void* c, int kind, int* value) {
    *value = ((Instance*)c)->terminate;
    return kind == 3 ? MODEL_OK : MODEL_DISCARD;
}

EXPORT int fmi2GetFMUstate(void* c, void** state) {
    if (*state == NULL) {
        *state = malloc(sizeof(Model));
    }
    return *state == NULL ? MODEL_ERROR : (memcpy(*state, &((Instance*)c)->model, sizeof(Model)), MODEL_OK);
}
EXPORT int fmi2SetFMUstate(void* c, void* state) {
    memcpy(&((Instance*)c)->model, state, sizeof(Model));
    return MODEL_OK;
}
EXPORT int fmi2FreeFMUstate(void* c, void** state) {
    (void)c;
    free(*state);
    *state = NULL;
    return MODEL_OK;
}
EXPORT int fmi2SerializedFMUstateSize(void* c, void* state, size_t* size) {
    (void)c, (void)state;
    *size = sizeof(Model);
    return MODEL_OK;
}
EXPORT int fmi2SerializeFMUstate(void* c, void* state, char* octets, size_t size) {
    (void)c;
    return size < sizeof(Model) ? MODEL_ERROR : (memcpy(octets, state, sizeof(Model)), MODEL_OK);
}
EXPORT int fmi2DeSerializeFMUstate(void* c, char const* octets, size_t size, void** state) {
    if (size != sizeof(Model) || fmi2GetFMUstate(c, state) != MODEL_OK) {
        return MODEL_ERROR;
    }
    memcpy(*state, octets, size);
    return MODEL_OK;
}
