// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "router/router_config.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::router {
namespace {

using config::Fields;
using config::Ref;

void read_tls(Fields& f, bus::TcpLink::Tls& tls) {
    f.file("certificate", tls.certificate, {.doc = "this site's certificate with its chain (PEM)", .required = true});
    f.file("private_key", tls.private_key, {.doc = "the certificate's private key (PEM)", .required = true});
    f.file("authority", tls.authority,
           {.doc = "certificate of the authority that must have signed the other site's (PEM)", .required = true});
}

/// A link over TCP, where one is wanted: `end.addresses` has been read.
void read_link(Fields& f, EndConfig& end) {
    std::int64_t listen = 0;
    std::string connect;
    f.integer(
        "listen", listen,
        {.doc = "a link over TCP: the port at which this site waits for others, on all interfaces; only with `tls`",
         .min = 1,
         .max = 65535});
    f.text("connect", connect, {.doc = "a link over TCP: address and port of the site that listens"});
    bool const has_link = f.has("listen") || f.has("connect");
    if (has_link) {
        bus::TcpLink& link = end.link.emplace();
        link.listens = f.has("listen");
        link.port = static_cast<std::uint16_t>(listen);
        auto const parts = host_and_port(connect);
        if (f.has("listen") && f.has("connect")) {
            f.error("connect", "a link either listens or connects", "remove `listen` or `connect`");
        } else if (!link.listens && !parts) {
            f.error("connect", fmt::format("'{}' is not ADDRESS:PORT", connect), "for example \"192.0.2.7:7411\"");
        } else if (!link.listens) {
            link.address = parts->first;
            link.port = parts->second;
        }
        if (!end.addresses.empty()) {
            f.error("addresses", "a link has none of its own");
        }
    }
    bus::TcpLink::Tls tls;
    if (f.object("tls", {.doc = "encrypts the link; each side proves who it is"},
                 [&](Fields& t) { read_tls(t, tls); })) {
        if (has_link) {
            end.link->tls = std::move(tls);
        } else {
            f.error("tls", "only a link has TLS", "give `listen` or `connect`, or a `qos` file that says it");
        }
    }
    if (has_link && end.link->listens && !f.has("tls")) { // Fast DDS 2.9 listens on all interfaces, or not at all
        f.error("listen",
                fmt::format("whoever reaches port {} of this machine could take part: that needs TLS", listen),
                "give `tls`: each side then shows a certificate of your authority "
                "(docs/how_to/connect_two_sites.md makes them)");
    }
}

void read_end(Fields& f, EndConfig& end) {
    f.integer("domain", end.domain, {.doc = "DDS domain; of a link, the same on both sides", .min = 0, .max = 232});
    using Run = EndConfig::Run;
    f.choice<Run>(
        "run", end.run, {{"management", Run::management}, {"data", Run::data}},
        {.doc = "instead of a domain: a network of the run in whose scenario the router is a `program: exec`"});
    if (end.run != Run::none && (f.has("domain") || f.has("addresses") || f.has("listen") || f.has("connect"))) {
        f.error("run", "the run says the domain and the addresses",
                "remove `domain`, `addresses`, `listen` and `connect`");
    }
    std::vector<Ref> addresses;
    f.references("addresses", addresses, {.doc = "IPv4 addresses of the interfaces to use; all when not given"});
    for (Ref& address : addresses) {
        end.addresses.push_back(std::move(address.name));
    }
    read_link(f, end);
    f.file("qos", end.qos,
           {.doc = "Fast DDS XML file with the participant profile to use instead of plain UDP: "
                   "qos/discovery_client.xml, qos/tcp_client.xml …"});
    f.text("profile", end.profile, {.doc = "participant profile in that file"});
    if (end.link && !end.qos.empty()) {
        f.error("qos", "a link makes its own participant", "remove `qos`, or `listen` and `connect`");
    }
    f.file(
        "network_namespace", end.network_namespace,
        {.doc = "network namespace in which the domain is, as a file (/proc/PID/ns/net, /run/netns/NAME); needs root"});
}

/// Ends by their names; all of them when nothing is written.
std::vector<std::size_t> ends_of(Fields& f, std::string_view key, std::vector<Ref> const& written,
                                 std::vector<EndConfig> const& ends) {
    std::vector<std::size_t> out;
    for (Ref const& ref : written) {
        auto const end =
            std::find_if(ends.begin(), ends.end(), [&](EndConfig const& e) { return e.name.name == ref.name; });
        if (end == ends.end()) {
            std::string known;
            for (EndConfig const& e : ends) {
                known += (known.empty() ? "" : ", ") + e.name.name;
            }
            f.error(key, fmt::format("there is no end '{}'", ref.name), known.empty() ? "" : "the ends are " + known);
        } else {
            out.push_back(static_cast<std::size_t>(end - ends.begin()));
        }
    }
    if (written.empty()) {
        for (std::size_t i = 0; i < ends.size(); ++i) {
            out.push_back(i);
        }
    }
    return out;
}

void read_topic(Fields& f, TopicConfig& topic, std::vector<EndConfig> const& ends) {
    std::string spelt;
    f.text("topic", spelt, {.doc = "its name on the bus, where that is no identifier (rt/chatter)"});
    if (!spelt.empty()) {
        topic.name = spelt;
    }
    std::vector<Ref> from, to;
    f.references("from", from, {.doc = "ends whose samples are carried; all when not given"});
    f.references("to", to, {.doc = "ends to which they are carried; all others when not given"});
    topic.from = ends_of(f, "from", from, ends);
    topic.to = ends_of(f, "to", to, ends);
    f.integer(
        "depth", topic.depth,
        {.doc =
             "samples of each instance that are kept for readers that are behind or come late; 0: as in qos/router.xml",
         .min = 0,
         .max = 100000});
    if (topic.name == "type_catalog") {
        f.error("", "type_catalog is carried by itself, as far as the types of carried topics need it", "remove it");
    }
    if (from.size() == 1 && to.size() == 1 && from.front().name == to.front().name) {
        f.error("to", "a topic is not carried to where it comes from");
    }
}

} // namespace

std::optional<std::pair<std::string, std::uint16_t>> host_and_port(std::string_view text) {
    std::size_t const colon = text.rfind(':');
    if (colon == std::string_view::npos || colon == 0) {
        return std::nullopt;
    }
    std::string_view const digits = text.substr(colon + 1);
    std::uint16_t port = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (error != std::errc{} || end != digits.data() + digits.size() || port == 0) {
        return std::nullopt;
    }
    return std::pair{std::string{text.substr(0, colon)}, port};
}

void describe(config::Fields& f, RouterConfig& config) {
    f.text("router", config.name,
           {.doc = "name of this router; others see it as the writer of what it carries", .required = true});
    f.map("ends", {.doc = "the DDS domains and links that it joins", .required = true},
          [&](Ref const& name, Fields& e) {
              EndConfig end;
              end.name = name;
              read_end(e, end);
              config.ends.push_back(std::move(end));
          });
    f.map("topics", {.doc = "the topics that may pass; no others do", .required = true},
          [&](Ref const& name, Fields& t) {
              TopicConfig topic;
              topic.name = name.name;
              read_topic(t, topic, config.ends);
              config.topics.push_back(std::move(topic));
          });
    if (f.has("ends") && config.ends.size() == 1) {
        f.error("ends", "a router has two ends at least");
    }
    for (std::size_t i = 0; i < config.ends.size(); ++i) {
        for (std::size_t j = i + 1; j < config.ends.size(); ++j) {
            EndConfig const &a = config.ends[i], &b = config.ends[j];
            if (!a.link && !b.link && a.run == b.run && a.domain == b.domain && a.addresses == b.addresses &&
                a.qos == b.qos && a.network_namespace == b.network_namespace) {
                f.error("ends", fmt::format("'{}' and '{}' are the same domain", a.name.name, b.name.name));
            }
        }
    }
}

Result<void> take_run_networks(RouterConfig& config, std::function<char const*(char const*)> const& variable) {
    for (EndConfig& end : config.ends) {
        if (end.run == EndConfig::Run::none) {
            continue;
        }
        std::string const network = end.run == EndConfig::Run::management ? "MANAGEMENT" : "DATA";
        char const* const domain = variable(("GRIDSPACE_" + network + "_DOMAIN").c_str());
        char const* const address = variable(("GRIDSPACE_" + network + "_ADDRESS").c_str());
        if (domain == nullptr) {
            return fail(
                ExitCode::usage,
                fmt::format("the end '{}' is a network of a run, and no run has started this router", end.name.name),
                "make it a process of the scenario (program: exec, command: [gridspace, router, ...]), or say the "
                "domain");
        }
        end.domain = std::strtol(domain, nullptr, 10);
        if (address != nullptr && *address != '\0') {
            end.addresses = {address};
        }
    }
    return {};
}

} // namespace gridspace::router
