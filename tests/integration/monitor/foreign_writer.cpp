// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// foreign_writer QOS_FILE DOMAIN [reliable|best_effort [TOPIC [TYPE]]]: writes topic `rt/weather` of a type that is
// published nowhere (foreign_types_test.py has its IDL) until its standard input ends.
#include "bus/participant.hpp"
#include "bus/raw_access.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <poll.h>
#include <string>

int main(int argc, char** argv) {
    using namespace gridspace;
    if (argc < 3) {
        return 2;
    }
    bus::ParticipantOptions options;
    bool const best_effort = argc > 3 && std::strcmp(argv[3], "best_effort") == 0;
    std::string const topic = argc > 4 ? argv[4] : "rt/weather";
    options.process = best_effort ? "gust" : "station";
    options.program = "foreign_writer";
    options.domain = static_cast<int>(std::strtol(argv[2], nullptr, 10));
    options.qos_file = argv[1];
    options.addresses = {"127.0.0.1"};
    auto participant = bus::Participant::create(std::move(options));
    bus::Codec codec;
    codec.type_name = argc > 5 ? argv[5] : "station::Weather";
    auto writer = !participant  ? std::unexpected{participant.error()}
                  : best_effort ? bus::create_writer_like(**participant, topic, codec, {})
                                : (*participant)->create_writer(topic, codec);
    if (!writer) {
        std::fprintf(stderr, "%s\n", describe(writer.error()).c_str());
        return 3;
    }
    // Little-endian CDR of {string "roof"; double 21.5; long -3}: header, length with the final zero, text, padding to
    // eight, double, long.
    std::array<std::byte, 4 + 4 + 5 + 7 + 8 + 4> sample{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0},
                                                        std::byte{5}};
    double const celsius = 21.5;
    std::int32_t const trend = -3;
    std::memcpy(&sample[8], "roof", 5);
    std::memcpy(&sample[20], &celsius, 8);
    std::memcpy(&sample[28], &trend, 4);
    pollfd input{0, POLLIN, 0};
    do {
        (void)(*writer)->write_cdr(sample, std::nullopt);
    } while (::poll(&input, 1, 50) == 0);
    return 0;
}
