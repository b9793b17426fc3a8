// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "lockstep_member.h"

#include "clock.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MAX_PROCESSES = 256,
    MAX_ENDPOINTS = 16,
    MAX_SOURCES = 64,
    MAX_PARTICIPANTS = 256,
    MAX_EXPECTED = 256,
    BATCH = 64,
    NAME = 65
};
enum { EXIT_USAGE = 2, EXIT_ENVIRONMENT = 3, EXIT_PEER_DIED = 4, EXIT_STALL = 5 };

// What a process says it has sent on one of our topics, and what has arrived.
typedef struct {
    uint64_t announced, held;
} count;

typedef struct {
    char name[NAME];
    uint32_t incarnation;
    count counts[MAX_ENDPOINTS]; // by reader
    bool upstream;
    int member;             // its number in the awaited bits, -1: none
    int64_t acked, awaited; // newest tick that it acknowledged, and in which it was awaited
    dds_instance_handle_t ack_writer;
    bool absent;       // the run goes on without it
    int64_t ledger_of; // newest tick of which we have its ledger
} process;

typedef struct {
    dds_instance_handle_t writer;
    int process;
    uint32_t incarnation;
} source;

typedef struct {
    char topic[NAME];
    dds_entity_t entity;
    int network;
    gs_deliver* deliver;
    void* user;
    source sources[MAX_SOURCES];
    int source_count;
} reader;

struct gs_writer {
    char topic[NAME];
    dds_entity_t entity;
    int network;
    uint64_t sent;
};

typedef struct {
    dds_guid_t key;
    char process[NAME];
    uint32_t incarnation;
    bool alive;
} participant;
typedef struct {
    char topic[NAME], process[NAME];
    int endpoints;
} expectation;

struct gs_member {
    char self[NAME], simulator[NAME];
    uint32_t incarnation;
    bool lockstep, ready, final_done;
    int64_t epoch_ns, joins_at_ns;        // a restarted process joins at that simulated time
    bool held;                            // and has seen the clock that is held for it,
    uint64_t held_tick;                   // after this tick,
    uint8_t restating[MAX_MEMBER_OCTETS]; // in which these members restate their ledgers
    bool restate;                         // we are such a member ourselves
    bool matched_long_enough;
    dds_entity_t domains[2], participants[2], participant_readers[2]; // 0: management, 1: data
    int networks;
    participant known[2][MAX_PARTICIPANTS];
    int known_count[2];
    process processes[MAX_PROCESSES];
    int process_count, self_member, simulator_index;
    reader readers[MAX_ENDPOINTS];
    int reader_count;
    gs_writer writers[MAX_ENDPOINTS];
    int writer_count;
    expectation expected_writers[MAX_EXPECTED], expected_readers[MAX_EXPECTED];
    int expected_writer_count, expected_reader_count;
    dds_entity_t clock_reader, ack_reader, ack_writer, status_writer, waitset;
    dds_instance_handle_t clock_writer;
    bool pending, pending_final;
    uint64_t pending_tick, generation, taken;
    int64_t pending_time_ns;
    char status[4096];
};

static void fail(int code, char const* format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "error: ");
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    exit(code);
}

static dds_entity_t made(dds_entity_t entity, char const* what) {
    if (entity < 0) {
        fail(EXIT_ENVIRONMENT, "DDS refused %s: %s", what, dds_strretcode(-entity));
    }
    return entity;
}

static char const* environment(char const* name) {
    char const* value = getenv(name);
    if (value == NULL) {
        fail(EXIT_USAGE, "%s is not set: `gridspace run` starts this program", name);
    }
    return value;
}

int64_t gs_environment_ns(char const* name) {
    char* end;
    double const numerator = strtod(environment(name), &end);
    return (int64_t)(numerator / (*end == '/' ? strtod(end + 1, NULL) : 1) * 1e9 + 0.5);
}

// ---- who is who

static int process_of(gs_member* m, char const* name, bool add) {
    for (int i = 0; i < m->process_count; ++i) {
        if (strcmp(m->processes[i].name, name) == 0) {
            return i;
        }
    }
    if (!add || m->process_count == MAX_PROCESSES) {
        return -1;
    }
    process* p = &m->processes[m->process_count];
    memset(p, 0, sizeof *p);
    snprintf(p->name, sizeof p->name, "%s", name);
    p->member = -1;
    p->acked = p->awaited = p->ledger_of = -1;
    return m->process_count++;
}

// A participant of the run says who it is in its user data; one that does not is known by its entity name.
static void describe_participant(dds_qos_t const* qos, participant* out) {
    void* data = NULL;
    size_t size = 0;
    char* name = NULL;
    out->process[0] = '\0';
    out->incarnation = 0;
    if (dds_qget_userdata(qos, &data, &size) && size > 0) { // CycloneDDS ends it with a zero
        char const* at = strncmp(data, "gridspace/1", 11) == 0 ? strstr(data, ";process=") : NULL;
        if (at != NULL) {
            sscanf(at, ";process=%64[^;];incarnation=%u", out->process, &out->incarnation);
        }
    }
    if (out->process[0] == '\0' && dds_qget_entity_name(qos, &name) && name != NULL) {
        snprintf(out->process, sizeof out->process, "%.64s", name);
    }
    dds_free(data);
    dds_free(name);
}

static void read_participants(gs_member* m, int network) {
    void* samples[BATCH] = {NULL};
    dds_sample_info_t infos[BATCH];
    int n;
    while ((n = dds_take(m->participant_readers[network], samples, infos, BATCH, BATCH)) > 0) {
        for (int i = 0; i < n; ++i) {
            dds_builtintopic_participant_t const* found = samples[i];
            participant* p = NULL;
            for (int k = 0; k < m->known_count[network]; ++k) {
                p = memcmp(&m->known[network][k].key, &found->key, sizeof found->key) == 0 ? &m->known[network][k] : p;
            }
            if (p == NULL && m->known_count[network] < MAX_PARTICIPANTS) {
                p = &m->known[network][m->known_count[network]++];
                p->key = found->key;
            }
            if (p == NULL) {
                continue;
            }
            p->alive = infos[i].instance_state == DDS_ALIVE_INSTANCE_STATE;
            if (infos[i].valid_data) {
                describe_participant(found->qos, p);
            }
            if (!p->alive && network == 0 && strcmp(p->process, m->simulator) == 0 && !m->final_done) {
                fail(EXIT_PEER_DIED, "the simulator '%s' is gone", m->simulator);
            }
        }
        dds_return_loan(m->participant_readers[network], samples, n);
        samples[0] = NULL;
    }
}

// Time stamps of DDS end in 2038: their seconds have 31 bits. Those of later times start again at 0 after this.
static int64_t const STAMP_PERIOD_NS = 2147483647LL * 1000000000;

static int64_t stamp_of(int64_t ns) {
    int64_t const rest = ns % STAMP_PERIOD_NS;
    return rest < 0 ? rest + STAMP_PERIOD_NS : rest;
}

// How long after `from_ns` the instant is that has this stamp; of all that could be meant, the nearest.
static int64_t stamp_after(int64_t stamp_ns, int64_t from_ns) {
    int64_t const ahead = stamp_of(stamp_ns - from_ns);
    return ahead < STAMP_PERIOD_NS / 2 ? ahead : ahead - STAMP_PERIOD_NS;
}

static participant const* owner_of(gs_member* m, int network, dds_builtintopic_endpoint_t const* endpoint) {
    read_participants(m, network);
    for (int k = 0; k < m->known_count[network]; ++k) {
        if (memcmp(&m->known[network][k].key, &endpoint->participant_key, sizeof endpoint->participant_key) == 0) {
            return &m->known[network][k];
        }
    }
    return NULL;
}

// ---- endpoints

static dds_qos_t* reliable(bool kept, int depth) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(qos, kept ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
    return qos;
}

static dds_entity_t open_endpoint(gs_member* m, int network, char const* topic_name, dds_topic_descriptor_t const* type,
                                  bool writes, bool kept, int depth) {
    dds_entity_t const participant = m->participants[network];
    dds_entity_t const topic = made(dds_create_topic(participant, type, topic_name, NULL, NULL), topic_name);
    dds_qos_t* qos = reliable(kept, depth);
    dds_entity_t const entity = made(writes ? dds_create_writer(participant, topic, qos, NULL)
                                            : dds_create_reader(participant, topic, qos, NULL),
                                     topic_name);
    dds_delete_qos(qos);
    if (!writes) {
        dds_set_status_mask(entity, DDS_DATA_AVAILABLE_STATUS);
        made(dds_waitset_attach(m->waitset, entity, 0), "a waitset");
    }
    return entity;
}

// The framework's own topics are on the management network, all others on the studied one.
static int network_of(gs_member const* m, char const* topic) {
    static char const* const own[] = {"simulation_clock", "clock_ack",      "member_status",
                                      "type_catalog",     "signal_catalog", "signals"};
    for (size_t i = 0; i < sizeof own / sizeof *own; ++i) {
        if (strcmp(topic, own[i]) == 0) {
            return 0;
        }
    }
    return m->networks - 1;
}

static void join_network(gs_member* m, int network, int domain, char const* address) {
    char config[512];
    // Multicast is asked for because the loopback interface does not offer it by itself.
    snprintf(config, sizeof config,
             "<General><Interfaces><NetworkInterface address=\"%s\" multicast=\"true\"/></Interfaces>"
             "<AllowMulticast>true</AllowMulticast></General>",
             address);
    m->domains[network] = made(dds_create_domain((dds_domainid_t)domain, address[0] != '\0' ? config : ""), "a domain");
    char user_data[256];
    int const size = snprintf(user_data, sizeof user_data, "gridspace/1;process=%s;incarnation=%u;program=exec",
                              m->self, m->incarnation);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_userdata(qos, user_data, (size_t)size);
    dds_qset_entity_name(qos, m->self);
    m->participants[network] = made(dds_create_participant((dds_domainid_t)domain, qos, NULL), "a participant");
    dds_delete_qos(qos);
    m->participant_readers[network] = made(
        dds_create_reader(m->participants[network], DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, NULL, NULL), "the participants");
    dds_set_status_mask(m->participant_readers[network], DDS_DATA_AVAILABLE_STATUS);
    made(dds_waitset_attach(m->waitset, m->participant_readers[network], 0), "a waitset");
}

// "topic:process:count topic:process:count"
static int read_expectations(char const* text, expectation* out) {
    int n = 0, used = 0;
    while (n < MAX_EXPECTED &&
           sscanf(text, " %64[^:]:%64[^:]:%d%n", out[n].topic, out[n].process, &out[n].endpoints, &used) == 3) {
        text += used;
        ++n;
    }
    return n;
}

static void expect(expectation* list, int* n, char const* topic, char const* process_name) {
    if (*n < MAX_EXPECTED) {
        expectation* e = &list[(*n)++];
        snprintf(e->topic, sizeof e->topic, "%s", topic);
        snprintf(e->process, sizeof e->process, "%s", process_name);
        e->endpoints = 1;
    }
}

gs_member* gs_join(void) {
    gs_member* m = calloc(1, sizeof *m);
    snprintf(m->self, sizeof m->self, "%s", environment("GRIDSPACE_PROCESS"));
    snprintf(m->simulator, sizeof m->simulator, "%s", environment("GRIDSPACE_SIMULATOR"));
    m->incarnation = (uint32_t)atoi(environment("GRIDSPACE_INCARNATION"));
    m->lockstep = strcmp(environment("GRIDSPACE_CLOCK_MODE"), "lockstep") == 0;
    m->epoch_ns = atoll(environment("GRIDSPACE_EPOCH_UNIX_S")) * 1000000000;
    m->joins_at_ns = gs_environment_ns("GRIDSPACE_JOINS_AT_S");
    m->waitset = made(dds_create_waitset(DDS_CYCLONEDDS_HANDLE), "a waitset");

    // Members are numbered in the order of their names, which is how the list comes.
    m->self_member = -1;
    m->simulator_index = process_of(m, m->simulator, true);
    char word[NAME];
    int number = 0, used = 0;
    for (char const* at = environment("GRIDSPACE_MEMBERS"); sscanf(at, " %64s%n", word, &used) == 1;
         at += used, ++number) {
        m->processes[process_of(m, word, true)].member = number;
        m->self_member = strcmp(word, m->self) == 0 ? number : m->self_member;
    }
    for (char const* at = environment("GRIDSPACE_ABSENT"); sscanf(at, " %64s%n", word, &used) == 1; at += used) {
        m->processes[process_of(m, word, true)].absent = true;
    }
    m->expected_writer_count = read_expectations(environment("GRIDSPACE_EXPECTED_WRITERS"), m->expected_writers);
    m->expected_reader_count = read_expectations(environment("GRIDSPACE_EXPECTED_READERS"), m->expected_readers);

    int const management = atoi(environment("GRIDSPACE_MANAGEMENT_DOMAIN")),
              data = atoi(environment("GRIDSPACE_DATA_DOMAIN"));
    m->networks = data == management ? 1 : 2;
    join_network(m, 0, management, environment("GRIDSPACE_MANAGEMENT_ADDRESS"));
    if (m->networks == 2) {
        join_network(m, 1, data, environment("GRIDSPACE_DATA_ADDRESS"));
    }
    m->status_writer = open_endpoint(m, 0, "member_status", &MemberStatus_desc, true, true, 1);
    m->clock_reader = open_endpoint(m, 0, "simulation_clock", &SimClock_desc, false, true, 256);
    expect(m->expected_writers, &m->expected_writer_count, "simulation_clock", m->simulator);
    if (m->lockstep) {
        m->ack_writer = open_endpoint(m, 0, "clock_ack", &ClockAck_desc, true, true, 64);
        expect(m->expected_readers, &m->expected_reader_count, "clock_ack", m->simulator);
        for (char const* at = environment("GRIDSPACE_DOWNSTREAM"); sscanf(at, " %64s%n", word, &used) == 1;
             at += used) {
            expect(m->expected_readers, &m->expected_reader_count, "clock_ack", word);
        }
        for (char const* at = environment("GRIDSPACE_UPSTREAM"); sscanf(at, " %64s%n", word, &used) == 1; at += used) {
            m->processes[process_of(m, word, true)].upstream = true;
            expect(m->expected_writers, &m->expected_writer_count, "clock_ack", word);
            if (m->ack_reader == 0) {
                m->ack_reader = open_endpoint(m, 0, "clock_ack", &ClockAck_desc, false, true, 1024);
            }
        }
    }
    return m;
}

void gs_reader(gs_member* m, char const* topic, dds_topic_descriptor_t const* type, gs_deliver* deliver, void* user) {
    if (m->reader_count == MAX_ENDPOINTS) {
        fail(EXIT_USAGE, "more than %d readers", MAX_ENDPOINTS);
    }
    reader* r = &m->readers[m->reader_count++];
    snprintf(r->topic, sizeof r->topic, "%s", topic);
    r->network = network_of(m, topic);
    r->deliver = deliver;
    r->user = user;
    r->entity = open_endpoint(m, r->network, topic, type, false, false, 1024);
}

gs_writer* gs_writer_of(gs_member* m, char const* topic, dds_topic_descriptor_t const* type) {
    if (m->writer_count == MAX_ENDPOINTS) {
        fail(EXIT_USAGE, "more than %d writers", MAX_ENDPOINTS);
    }
    gs_writer* w = &m->writers[m->writer_count++];
    snprintf(w->topic, sizeof w->topic, "%s", topic);
    w->network = network_of(m, topic);
    w->entity = open_endpoint(m, w->network, topic, type, true, false, 128);
    return w;
}

// ---- READY

// How many endpoints of `process_name` (of its newest incarnation) `entity` is matched with.
static int matched_with(gs_member* m, int network, dds_entity_t entity, bool entity_reads, char const* process_name,
                        uint32_t* incarnation) {
    dds_instance_handle_t handles[256];
    int const n = entity_reads ? dds_get_matched_publications(entity, handles, 256)
                               : dds_get_matched_subscriptions(entity, handles, 256);
    int matched = 0;
    *incarnation = 0;
    for (int i = 0; i < n && i < 256; ++i) {
        dds_builtintopic_endpoint_t* endpoint = entity_reads ? dds_get_matched_publication_data(entity, handles[i])
                                                             : dds_get_matched_subscription_data(entity, handles[i]);
        if (endpoint == NULL) {
            continue;
        }
        participant const* owner = owner_of(m, network, endpoint);
        if (owner != NULL && owner->alive && strcmp(owner->process, process_name) == 0 &&
            owner->incarnation >= *incarnation) {
            matched = owner->incarnation > *incarnation ? 1 : matched + 1;
            *incarnation = owner->incarnation;
        }
        dds_builtintopic_free_endpoint(endpoint);
    }
    return matched;
}

static void look(gs_member* m, int network, dds_entity_t entity, bool entity_reads, char const* topic,
                 MemberStatus* status) {
    expectation const* list = entity_reads ? m->expected_writers : m->expected_readers;
    int const n = entity_reads ? m->expected_writer_count : m->expected_reader_count;
    for (int i = 0; i < n; ++i) {
        int const index = process_of(m, list[i].process, false);
        if (strcmp(list[i].topic, topic) != 0 || (index >= 0 && m->processes[index].absent)) {
            continue;
        }
        uint32_t incarnation;
        int const matched = matched_with(m, network, entity, entity_reads, list[i].process, &incarnation);
        if (matched < list[i].endpoints) {
            size_t const used = strlen(status->waiting_for);
            snprintf(status->waiting_for + used, sizeof status->waiting_for - used, "%s%d of %d %s(s) of '%s' in %s",
                     used > 0 ? ", " : "", list[i].endpoints - matched, list[i].endpoints,
                     entity_reads ? "writer" : "reader", topic, list[i].process);
            continue;
        }
        uint32_t k = 0;
        while (k < status->matched._length && strcmp(status->matched._buffer[k].process, list[i].process) != 0) {
            ++k;
        }
        if (k == status->matched._length && k < status->matched._maximum) {
            snprintf(status->matched._buffer[k].process, sizeof status->matched._buffer[k].process, "%s",
                     list[i].process);
            ++status->matched._length;
        }
        MatchedPeer* peer = &status->matched._buffer[k];
        if (peer->incarnation != 0 &&
            peer->incarnation != incarnation) { // some endpoints know the old incarnation only
            snprintf(status->waiting_for, sizeof status->waiting_for, "the restarted %s", list[i].process);
        }
        peer->incarnation = incarnation > peer->incarnation ? incarnation : peer->incarnation;
    }
}

static bool bit(uint8_t const* bits, uint32_t octets, int i) {
    return i >= 0 && (uint32_t)i / 8 < octets && (bits[i / 8] >> (i % 8) & 1) != 0;
}

// A new incarnation cannot count before it knows what was sent without it.
static void await_ledgers(gs_member const* m, MemberStatus* status) {
    if (!m->held) {
        snprintf(status->waiting_for, sizeof status->waiting_for, "the clock of the tick after which it joins");
        return;
    }
    for (int i = 0; i < m->process_count; ++i) {
        process const* p = &m->processes[i];
        if (p->upstream && bit(m->restating, sizeof m->restating, p->member) && p->ledger_of < (int64_t)m->held_tick) {
            snprintf(status->waiting_for, sizeof status->waiting_for, "the ledger of %s", p->name);
        }
    }
}

// Looks at all matches and informs the others when something has changed. True: everybody expected is there.
static bool refresh_status(gs_member* m) {
    static MatchedPeer peers[MAX_PEERS];
    MemberStatus status;
    memset(&status, 0, sizeof status);
    memset(peers, 0, sizeof peers);
    status.matched._buffer = peers;
    status.matched._maximum = MAX_PEERS;
    snprintf(status.process, sizeof status.process, "%s", m->self);
    status.incarnation = m->incarnation;
    for (int i = 0; i < m->reader_count; ++i) {
        look(m, m->readers[i].network, m->readers[i].entity, true, m->readers[i].topic, &status);
    }
    for (int i = 0; i < m->writer_count; ++i) {
        look(m, m->writers[i].network, m->writers[i].entity, false, m->writers[i].topic, &status);
    }
    look(m, 0, m->clock_reader, true, "simulation_clock", &status);
    if (m->ack_reader != 0) {
        look(m, 0, m->ack_reader, true, "clock_ack", &status);
    }
    if (m->ack_writer != 0) {
        look(m, 0, m->ack_writer, false, "clock_ack", &status);
    }
    if (status.waiting_for[0] == '\0' && m->lockstep && m->incarnation > 0 && !m->ready) {
        await_ledgers(m, &status);
    }
    bool const complete = status.waiting_for[0] == '\0';
    if (complete && !m->matched_long_enough) {
        return true;
    }
    m->ready = m->ready || complete; // before anybody hears of it: the clock may come at once
    status.state = m->ready ? MEMBER_READY : MEMBER_STARTING;
    char text[sizeof m->status];
    int used = snprintf(text, sizeof text, "%d %s", (int)status.state, status.waiting_for);
    for (uint32_t i = 0; i < status.matched._length && used < (int)sizeof text - 80; ++i) {
        used += snprintf(text + used, sizeof text - (size_t)used, " %s/%u", peers[i].process, peers[i].incarnation);
    }
    if (strcmp(text, m->status) != 0) {
        strcpy(m->status, text);
        made(dds_write(m->status_writer, &status), "member_status");
    }
    return complete;
}

// ---- arrivals

static void enter_incarnation(process* p, uint32_t incarnation) {
    if (incarnation > p->incarnation) {
        p->incarnation = incarnation;
        memset(p->counts, 0, sizeof p->counts);
    }
}

static void take_ledger(gs_member* m, int index, uint32_t incarnation, dds_sequence_LedgerEntry const* ledger) {
    process* p = &m->processes[index];
    enter_incarnation(p, incarnation);
    if (incarnation < p->incarnation) {
        return;
    }
    for (uint32_t i = 0; i < ledger->_length; ++i) {
        for (int r = 0; r < m->reader_count; ++r) {
            if (strcmp(ledger->_buffer[i].topic, m->readers[r].topic) != 0) {
                continue;
            }
            count* c = &p->counts[r];
            uint64_t const sent = ledger->_buffer[i].sent;
            c->announced = sent > c->announced ? sent : c->announced;
            if (!m->ready && m->incarnation > 0) {
                c->held = c->announced; // sent before this incarnation was ready: it counts as held
            }
        }
    }
}

static void on_clock(gs_member* m, SimClock const* clock) {
    if (clock->state == CLOCK_ABORTED) {
        fail(EXIT_STALL, "the simulator has ended the run");
    }
    take_ledger(m, m->simulator_index, 0, &clock->ledger);
    if (clock->state == CLOCK_HELD) { // somebody was restarted after this tick
        m->pending_time_ns = clock->time_ns;
        if (m->ready) {
            m->restate = bit(clock->awaited._buffer, clock->awaited._length, m->self_member);
            m->held_tick = clock->tick;
        } else if (m->incarnation > 0 && clock->time_ns >= m->joins_at_ns) {
            m->held = true;
            m->held_tick = clock->tick;
            memcpy(m->restating, clock->awaited._buffer, clock->awaited._length);
        }
        return;
    }
    ++m->generation;
    if (!m->ready) {
        return;
    }
    for (int i = 0; i < m->process_count; ++i) {
        if (m->processes[i].upstream && bit(clock->awaited._buffer, clock->awaited._length, m->processes[i].member)) {
            m->processes[i].awaited = (int64_t)clock->tick;
        }
    }
    if (!m->lockstep || bit(clock->awaited._buffer, clock->awaited._length, m->self_member)) {
        m->pending = true;
        m->pending_tick = clock->tick;
        m->pending_time_ns = clock->time_ns;
        m->pending_final = clock->state == CLOCK_FINAL;
    }
}

// Clocks count from the simulator alone, acknowledgements from the member that they name: another run may be on this
// bus.
static bool written_by(gs_member* m, dds_entity_t reader, dds_instance_handle_t writer, char const* process_name,
                       dds_instance_handle_t* known) {
    if (writer == *known) {
        return true;
    }
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer);
    participant const* owner = endpoint == NULL ? NULL : owner_of(m, 0, endpoint);
    bool const ours = owner != NULL && strcmp(owner->process, process_name) == 0;
    if (endpoint != NULL) {
        dds_builtintopic_free_endpoint(endpoint);
    }
    if (ours) {
        *known = writer;
    }
    return ours;
}

static void on_ack(gs_member* m, ClockAck const* ack, dds_instance_handle_t writer) {
    int const index = process_of(m, ack->member, false);
    if (index < 0 || !m->processes[index].upstream ||
        !written_by(m, m->ack_reader, writer, ack->member, &m->processes[index].ack_writer)) {
        return;
    }
    take_ledger(m, index, ack->incarnation, &ack->ledger);
    m->processes[index].ledger_of = (int64_t)ack->tick;
    bool const is_restated = ack->next_tick_needed == 0;
    if (!is_restated && (int64_t)ack->tick > m->processes[index].acked) {
        m->processes[index].acked = (int64_t)ack->tick;
    }
}

static source* source_of(gs_member* m, reader* r, dds_instance_handle_t writer) {
    for (int i = 0; i < r->source_count; ++i) {
        if (r->sources[i].writer == writer) {
            return &r->sources[i];
        }
    }
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(r->entity, writer);
    if (endpoint == NULL || r->source_count == MAX_SOURCES) {
        return NULL;
    }
    participant const* owner = owner_of(m, r->network, endpoint);
    source* s = &r->sources[r->source_count++];
    s->writer = writer;
    s->process = owner == NULL ? -1 : process_of(m, owner->process, false);
    s->incarnation = owner == NULL ? 0 : owner->incarnation;
    dds_builtintopic_free_endpoint(endpoint);
    return s;
}

static void on_sample(gs_member* m, reader* r, void const* sample, dds_sample_info_t const* info) {
    source const* s = source_of(m, r, info->publication_handle);
    if (s == NULL || s->process < 0) {
        if (!m->lockstep) {
            r->deliver(r->user, sample, stamp_after(info->source_timestamp, m->epoch_ns));
        }
        return; // a run must not depend on who else is on the bus
    }
    process* p = &m->processes[s->process];
    enter_incarnation(p, s->incarnation);
    if (s->incarnation < p->incarnation || (!m->ready && m->incarnation > 0)) {
        return;
    }
    ++p->counts[r - m->readers].held;
    r->deliver(r->user, sample, stamp_after(info->source_timestamp, m->epoch_ns));
}

// Takes all that has arrived at one reader.
static void drain(gs_member* m, dds_entity_t entity, reader* r) {
    void* samples[BATCH] = {NULL};
    dds_sample_info_t infos[BATCH];
    int n;
    while ((n = dds_take(entity, samples, infos, BATCH, BATCH)) > 0) {
        for (int i = 0; i < n; ++i) {
            if (!infos[i].valid_data) {
                continue; // an instance went away
            }
            if (r != NULL) {
                on_sample(m, r, samples[i], &infos[i]);
            } else if (entity == m->clock_reader) {
                if (written_by(m, entity, infos[i].publication_handle, m->simulator, &m->clock_writer)) {
                    on_clock(m, samples[i]);
                }
            } else {
                on_ack(m, samples[i], infos[i].publication_handle);
            }
        }
        dds_return_loan(entity, samples, n);
        samples[0] = NULL;
    }
}

static void drain_all(gs_member* m) {
    for (int network = 0; network < m->networks; ++network) {
        read_participants(m, network);
    }
    for (int i = 0; i < m->reader_count; ++i) {
        drain(m, m->readers[i].entity, &m->readers[i]);
    }
    if (m->ack_reader != 0) {
        drain(m, m->ack_reader, NULL);
    }
    drain(m, m->clock_reader, NULL);
}

static bool holds_everything_of(gs_member const* m, process const* p) {
    for (int r = 0; r < m->reader_count; ++r) {
        if (p->counts[r].held < p->counts[r].announced) {
            return false;
        }
    }
    return true;
}

static bool granted(gs_member const* m) {
    if (!m->lockstep) {
        return m->pending && m->generation != m->taken;
    }
    if (!m->pending || !holds_everything_of(m, &m->processes[m->simulator_index])) {
        return false;
    }
    for (int i = 0; i < m->process_count; ++i) {
        process const* p = &m->processes[i];
        if (p->upstream && (p->acked < p->awaited || !holds_everything_of(m, p))) {
            return false;
        }
    }
    return true;
}

// ---- the life of a member

void gs_start(gs_member* m) {
    // CycloneDDS drops what it gets of a volatile writer before that writer's first heartbeat, which follows the match
    // and cannot be seen from here. So a match must be a little old before others may count on it.
    int settled = 0;
    while (settled < 10) {
        m->matched_long_enough = settled == 9;
        settled = refresh_status(m) ? settled + 1 : 0;
        if (settled < 10) {
            dds_sleepfor(DDS_MSECS(50));
        }
        drain_all(m);
    }
}

// "I have done all work of this tick", and how many samples have been sent until now, per topic.
static void acknowledge(gs_member* m, uint64_t tick, int64_t time_ns, uint64_t next_tick_needed) {
    static LedgerEntry entries[MAX_ENDPOINTS];
    ClockAck ack;
    memset(&ack, 0, sizeof ack);
    snprintf(ack.member, sizeof ack.member, "%s", m->self);
    ack.incarnation = m->incarnation;
    ack.tick = tick;
    ack.next_tick_needed = next_tick_needed;
    ack.ledger._buffer = entries;
    ack.ledger._maximum = MAX_ENDPOINTS;
    for (int i = 0; i < m->writer_count; ++i) {
        uint32_t k = 0;
        while (k < ack.ledger._length && strcmp(entries[k].topic, m->writers[i].topic) != 0) {
            ++k;
        }
        if (k == ack.ledger._length) {
            memset(&entries[k], 0, sizeof entries[k]);
            snprintf(entries[k].topic, sizeof entries[k].topic, "%s", m->writers[i].topic);
            ++ack.ledger._length;
        }
        entries[k].sent += m->writers[i].sent;
    }
    made(dds_write_ts(m->ack_writer, &ack, stamp_of(m->epoch_ns + time_ns)), "an acknowledgement");
}

// What is missing, for people who look into the log of a run that has stalled.
static void explain(gs_member const* m) {
    fprintf(stderr, "tick %llu waits for:", (unsigned long long)m->pending_tick);
    for (int i = 0; i < m->process_count; ++i) {
        process const* p = &m->processes[i];
        if (p->upstream && p->acked < p->awaited) {
            fprintf(stderr, " the acknowledgement of tick %lld by %s;", (long long)p->awaited, p->name);
        }
        for (int r = 0; r < m->reader_count; ++r) {
            if (p->counts[r].held < p->counts[r].announced) {
                fprintf(stderr, " %llu of %llu samples of '%s' from %s;",
                        (unsigned long long)(p->counts[r].announced - p->counts[r].held),
                        (unsigned long long)p->counts[r].announced, m->readers[r].topic, p->name);
            }
        }
    }
    fprintf(stderr, "\n");
}

bool gs_next(gs_member* m, gs_tick* tick) {
    int quiet = 0;
    while (!m->final_done) {
        drain_all(m);
        if (m->restate) {
            m->restate = false;
            acknowledge(m, m->held_tick, m->pending_time_ns, 0);
        }
        if (granted(m)) {
            m->taken = m->generation;
            *tick = (gs_tick){m->pending_tick, m->pending_time_ns, m->pending_final};
            return true;
        }
        if (dds_waitset_wait(m->waitset, NULL, 0, DDS_MSECS(100)) == 0) {
            refresh_status(m); // quiet: somebody may be restarting, and must hear that we are matched again
            if (++quiet == 20 && m->pending) {
                explain(m);
            }
        }
    }
    return false;
}

void gs_write(gs_member* m, gs_writer* writer, void const* sample, int64_t time_ns) {
    dds_return_t const result =
        m->lockstep ? dds_write_ts(writer->entity, sample, stamp_of(m->epoch_ns + time_ns)) : dds_write(writer->entity, sample);
    if (result != DDS_RETCODE_OK) {
        fail(EXIT_STALL, "DDS refused a sample of '%s': %s", writer->topic, dds_strretcode(-result));
    }
    ++writer->sent;
}

void gs_done(gs_member* m, gs_tick const* tick, uint64_t next_tick_needed) {
    m->pending = false;
    m->final_done = tick->final;
    if (!m->lockstep) {
        return;
    }
    acknowledge(m, tick->number, tick->time_ns, next_tick_needed > tick->number ? next_tick_needed : tick->number + 1);
    if (tick->final) {
        dds_wait_for_acks(m->ack_writer, DDS_SECS(5)); // leaving before the simulator has it would look like a death
    }
}

void gs_leave(gs_member* m) {
    dds_delete(DDS_CYCLONEDDS_HANDLE);
    free(m);
}
