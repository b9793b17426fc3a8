// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/app/recorder_config.hpp"

namespace gridspace::recorder {

void describe_own(config::Fields& f, RecorderConfig& config) {
    f.flag("compress", config.compress, {.doc = "compress the recording (zstd) and the capture (gzip)"});
}

program::Declaration recorder_declaration() {
    return {.name = "gridspace-recorder",
            .description = "records every sample and every frame of a run",
            .role = "recorder",
            .settings = config::keys_of([](config::Fields& f) {
                RecorderConfig any;
                describe_own(f, any);
            })};
}

void describe(config::Fields& f, RecorderConfig& config) {
    f.file("file", config.file, {.doc = "the recording (MCAP)"});
    f.map("topics", {.doc = "topics to record; filled in by `gridspace run` with all of the scenario"},
          [&](config::Ref const& name, config::Fields& t) {
              RecorderConfig::Topic topic;
              topic.name = name.name;
              t.text("type", topic.type, {.doc = "name of the type on the wire", .required = true});
              t.file("idl", topic.idl, {.doc = "IDL file of a type that Gridspace does not know"});
              config.topics.push_back(std::move(topic));
          });
    f.object("capture", {.doc = "raw frames; filled in by `gridspace run`"}, [&](config::Fields& c) {
        c.file("file", config.capture.file, {.doc = "the capture (pcapng)"});
        std::string name_space;
        c.text("network_namespace", name_space, {.doc = "network namespace of the interfaces, as a file"});
        config.capture.network_namespace = name_space;
        c.list("ports", {.doc = "interfaces whose incoming frames are captured"}, [&](config::Fields& p) {
            CaptureConfig::Port port;
            p.text("name", port.name, {.doc = "name in the capture", .required = true});
            p.text("description", port.description, {.doc = "beside it, for people"});
            p.text("interface", port.interface, {.doc = "network interface", .required = true});
            p.text("host", port.host, {.doc = "host in whose network it is; none: network_namespace"});
            p.text("link", port.link,
                   {.doc = "the link that it belongs to; in lockstep none: incoming frames are not captured"});
            p.flag("both_ways", port.both_ways, {.doc = "outgoing frames too"});
            p.text("link_out", port.link_out, {.doc = "the piece of cable of outgoing frames, in lockstep"});
            config.capture.ports.push_back(std::move(port));
        });
    });
    describe_own(f, config);
}

} // namespace gridspace::recorder
