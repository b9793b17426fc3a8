// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "launcher/wire/live.hpp"
#include "launcher/wire/observer.hpp"
#include "launcher/wire/test_pattern.hpp"
#include "launcher/wire/tools.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::wire {
namespace {

using namespace iec61850;
using Json = nlohmann::ordered_json;

Json value_json(Value const& v) {
    if (v.type == BasicType::boolean) {
        return v.boolean();
    }
    if (is_float(v.type)) {
        return v.number();
    }
    if (is_unsigned(v.type) || v.type == BasicType::quality) {
        return v.bits;
    }
    return is_integer(v.type) ? Json(v.as_signed()) : Json(to_string(v));
}

void print_frame(SvFrame const& frame, std::int64_t stamp_ns, streams::Stream const* wanted, SvLayout const* layout) {
    for (Asdu const& asdu : frame.view()) {
        if (wanted != nullptr && !wanted->sv_id.empty() && asdu.sv_id != wanted->sv_id) {
            continue;
        }
        Json out{{"time_ns", stamp_ns},           {"sv_id", visible(asdu.sv_id)},
                 {"app_id", frame.header.app_id}, {"source", frame.header.source.to_string()},
                 {"smp_cnt", asdu.smp_cnt},       {"conf_rev", asdu.conf_rev},
                 {"smp_synch", asdu.smp_synch},   {"simulated", frame.header.simulated()}};
        if (frame.header.vlan) {
            out["vlan"] = {{"id", frame.header.vlan->id}, {"priority", frame.header.vlan->priority}};
        }
        if (asdu.has(Asdu::dat_set_field)) {
            out["dat_set"] = visible(asdu.dat_set);
        }
        if (asdu.has(Asdu::refr_tm_field)) {
            out["refr_tm_ns"] = asdu.refr_tm.nanoseconds();
            out["refr_tm_quality"] = time_quality_text(asdu.refr_tm);
        }
        if (asdu.has(Asdu::smp_rate_field)) {
            out["smp_rate"] = asdu.smp_rate;
        }
        if (asdu.has(Asdu::smp_mod_field)) {
            out["smp_mod"] = asdu.smp_mod;
        }
        if (asdu.has(Asdu::gm_identity_field)) {
            out["gm_identity"] = fmt::format("{:016X}", asdu.gm_identity);
        }
        if (layout != nullptr && layout->sample_octets() == asdu.sample.size()) {
            for (std::size_t i = 0; i < layout->slots().size(); ++i) {
                out["values"][layout->slots()[i].leaf.name] = value_json(layout->read(i, asdu.sample));
            }
        } else {
            Value raw;
            raw.type = BasicType::octet_string;
            raw.text = asdu.sample;
            out["sample"] = to_string(raw);
        }
        fmt::print("{}\n", out.dump());
    }
}

void print_second(Observer const& observer, ethernet::Port& port) {
    Json out{{"time_ns", utc_ns()},
             {"dropped", port.counters().dropped},
             {"foreign", port.foreign()},
             {"undecodable", observer.errors().total()},
             {"streams", Json::array()}};
    for (ObservedStream const* s : observer.streams()) {
        auto const& a = s->counter->arrivals();
        out["streams"].push_back({{"sv_id", s->id},
                                  {"frames", s->frames},
                                  {"rate_hz", s->rate_hz()},
                                  {"lost", s->lost},
                                  {"duplicates", s->duplicates},
                                  {"late", s->out_of_order},
                                  {"restarts", s->restarts},
                                  {"smp_synch", s->smp_synch},
                                  {"shortest_gap_us", static_cast<double>(a.shortest_ns()) / 1e3},
                                  {"longest_gap_us", static_cast<double>(a.longest_ns()) / 1e3},
                                  {"state", s->alive(utc_ns()) ? "alive" : "silent"}});
    }
    fmt::print("{}\n", out.dump());
    std::fflush(stdout);
}

/// Stream number `i` of --streams: APPID, address and svID count up.
Result<streams::Stream> numbered(streams::Stream stream, int i) {
    if (i == 0) {
        return stream;
    }
    if (stream.address.app_id + i > 0xFFFF) {
        return fail(ExitCode::usage,
                    fmt::format("the APPID of stream {} would be 0x{:X}", i + 1, stream.address.app_id + i),
                    "APPIDs end at 0xFFFF: a lower app_id or fewer --streams");
    }
    stream.address.app_id = static_cast<std::uint16_t>(stream.address.app_id + i);
    auto& mac = stream.address.destination.octets;
    int const low = (mac[4] << 8) + mac[5] + i; // carries into the octet above, as the recommended ranges do
    mac[4] = static_cast<std::uint8_t>(low >> 8);
    mac[5] = static_cast<std::uint8_t>(low);
    stream.sv_id += fmt::format("_{}", i + 1);
    return stream;
}

/// A publisher for each of the streams that count up from the described one.
Result<std::vector<SvPublisher>> make_publishers(streams::Stream const& described, Mac const& source, int count) {
    std::vector<SvPublisher> publishers;
    for (int i = 0; i < count; ++i) {
        auto const one = numbered(described, i);
        if (!one) {
            return std::unexpected{one.error()};
        }
        auto frame = one->sv_template(source);
        if (!frame) {
            return std::unexpected{frame.error()};
        }
        frame->set_simulated(one->address.simulated);
        publishers.emplace_back(std::move(*frame), static_cast<std::uint32_t>(one->rate_hz.num()));
    }
    return publishers;
}

/// Where the samples are on the clocks: sample 0 is at the last whole UTC second, unless the counter was chosen.
struct SampleOrigin {
    std::int64_t zero_ns{0}, zero_utc_ns{0}; ///< of sample 0, on the monotonic clock and since 1970
    std::int64_t first_frame{0};
    std::int64_t offset{0}; ///< of smpCnt from the number of the sample
};

SampleOrigin origin_of(std::int64_t first_smp_cnt, double rate_hz, std::int64_t samples_per_frame) {
    std::int64_t const now = monotonic_ns(), utc = utc_ns(), into_second = utc % 1'000'000'000;
    if (first_smp_cnt >= 0) {
        return {now, utc, 0, first_smp_cnt / samples_per_frame * samples_per_frame};
    }
    return {now - into_second, utc - into_second,
            static_cast<std::int64_t>(static_cast<double>(into_second) * 1e-9 * rate_hz) / samples_per_frame + 1, 0};
}

std::uint8_t time_quality_of(streams::Stream const& stream) {
    constexpr std::uint8_t kAccuracyBits = 0x0A; // about a millisecond
    bool const synchronised = stream.smp_synch != kNotSynchronised;
    return static_cast<std::uint8_t>(kAccuracyBits | (synchronised ? 0U : unsigned{UtcTime::kNotSynchronised}));
}

/// Until the time is over or Ctrl-C.
void publish(std::vector<SvPublisher>& publishers, streams::Stream const& stream, TestPattern const& pattern,
             SampleOrigin const& origin, SendSchedule& schedule, ethernet::Port& port, Duration const& duration) {
    auto const per_frame = static_cast<std::int64_t>(publishers[0].samples_per_frame());
    SampleGrid const grid{stream.rate_hz};
    std::uint8_t const time_quality = time_quality_of(stream);
    std::vector<Octets> batch;
    while (!duration.over()) {
        sleep_until(schedule.due_ns());
        std::size_t const owed = schedule.owed(monotonic_ns(), 16);
        for (std::size_t k = 0; k < owed; ++k) {
            batch.clear();
            for (SvPublisher& publisher : publishers) {
                for (std::int64_t s = 0; s < per_frame; ++s) {
                    std::int64_t const number = schedule.next_frame() * per_frame + s, index = number + origin.offset;
                    pattern.write(index, publisher.sample(index));
                    if (stream.send_refr_tm) { // the time of the sample, not of this wake-up
                        publisher.frame().set_refr_tm(
                            static_cast<std::size_t>(s),
                            UtcTime::from_nanoseconds(origin.zero_utc_ns + grid.nanoseconds(number), time_quality));
                    }
                    if (Octets const frame = publisher.commit(); !frame.empty()) {
                        batch.push_back(frame);
                    }
                }
            }
            port.send(batch);
            schedule.sent(1);
        }
    }
}

/// What is subscribed to, as far as it was chosen.
struct Subscribed {
    std::optional<streams::Stream> wanted;
    std::optional<SvLayout> layout;
    ethernet::PortOptions port;
};

Result<Subscribed> subscribed_by(SvSubscribeOptions const& o) {
    Subscribed out;
    out.port.interface = o.interface;
    out.port.filter.ethertypes = {kSvEthertype};
    if (o.stream.file.empty() && o.stream.keys.empty()) {
        return out;
    }
    out.wanted = read_stream(o.stream, streams::Kind::smv);
    if (!out.wanted) {
        return fail(ExitCode::usage, "the stream cannot be subscribed");
    }
    out.layout.emplace(out.wanted->data_set);
    // What was not named is a default of publishers: any stream is taken, and decoded by that data set.
    if (!is_named(o.stream, "sv_id")) {
        out.wanted->sv_id.clear();
    }
    if (is_named(o.stream, "mac")) {
        out.port.filter.destinations = {out.wanted->address.destination};
    }
    if (is_named(o.stream, "app_id")) {
        out.port.filter.app_ids = {out.wanted->address.app_id};
    }
    return out;
}

} // namespace

Result<void> sv_publish(SvPublishOptions const& o) {
    auto opened = open_sending(o.interface, o.stream, streams::Kind::smv, o.source);
    if (!opened) {
        return std::unexpected{opened.error()};
    }
    auto& [stream, port, source] = *opened;
    auto publishers = make_publishers(stream, source, o.streams);
    if (!publishers) {
        return std::unexpected{publishers.error()};
    }
    catch_signals();
    SvLayout const layout{stream.data_set};
    double const rate = stream.rate_hz.to_double();
    TestPattern const pattern{layout, o.amplitude, o.frequency_hz, rate};
    std::size_t const per_frame = publishers->front().samples_per_frame();
    SampleOrigin const origin = origin_of(o.first_smp_cnt, rate, static_cast<std::int64_t>(per_frame));
    SendSchedule schedule{stream.rate_hz, per_frame, origin.zero_ns, origin.first_frame};
    publish(*publishers, stream, pattern, origin, schedule, port, Duration{o.duration_s});
    auto const& c = port.counters();
    Json const out{{"sent", c.sent},
                   {"not_sent", c.send_failed},
                   {"late_wakeups", schedule.late_wakeups()},
                   {"worst_late_us", static_cast<double>(schedule.worst_late_ns()) / 1e3}};
    fmt::print("{}\n", out.dump());
    return check_sent(port);
}

Result<void> sv_subscribe(SvSubscribeOptions const& o) {
    auto const subscribed = subscribed_by(o);
    if (!subscribed) {
        return std::unexpected{subscribed.error()};
    }
    auto const& wanted = subscribed->wanted;
    auto const& layout = subscribed->layout;
    auto port = ethernet::Port::open(subscribed->port);
    if (!port) {
        return std::unexpected{port.error()};
    }
    catch_signals();
    Observer observer{wanted ? wanted->sv_id : std::string{}};
    auto const taken = [&] { return observer.frames() - observer.unwanted(); };
    auto frame = std::make_unique<SvFrame>();
    std::vector<ethernet::ReceivedFrame> batch(256);
    Duration const duration{o.duration_s};
    std::int64_t next = monotonic_ns() + 1'000'000'000;
    std::uint64_t said_of = ~std::uint64_t{0}; // frames that the last line spoke of
    while (!duration.over() && (o.count == 0 || taken() < o.count)) {
        port->wait(std::max<std::int64_t>(
            1, std::min({next - monotonic_ns(), duration.end_ns() - monotonic_ns(), std::int64_t{100'000'000}})));
        for (std::size_t n = port->receive(batch), i = 0; i < n && (o.count == 0 || taken() < o.count); ++i) {
            std::int64_t const stamp = batch[i].stamp_ns != 0 ? batch[i].stamp_ns : utc_ns();
            observer.add(batch[i].octets, stamp);
            if (!o.frames) {
                continue;
            }
            if (auto const ok = decode_sv(batch[i].octets, *frame); ok) {
                print_frame(*frame, stamp, wanted ? &*wanted : nullptr, layout ? &*layout : nullptr);
            } else {
                fmt::print("{}\n", Json{{"time_ns", stamp}, {"error", describe(ok.error())}}.dump());
            }
        }
        if (o.frames) {
            std::fflush(stdout); // who reads them in a pipe gets them while they are new
        }
        if (monotonic_ns() >= next) {
            next += 1'000'000'000;
            port->maintain();
            if (!o.frames) {
                print_second(observer, *port);
                said_of = observer.frames();
            }
        }
    }
    if (!o.frames && said_of != observer.frames()) {
        print_second(observer, *port);
    }
    return {};
}

} // namespace gridspace::wire
