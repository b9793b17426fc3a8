// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/streams/stream.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/authentication.hpp"
#include "gateways/streams/stream_data_set.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::streams {
namespace {

using config::Fields;
using config::Node;

constexpr double kLongestLiveMs = 4294967295.0; ///< timeAllowedToLive has 32 bits

void describe_address(Fields& f, Stream& stream) {
    std::string mac;
    describe(f, stream.udp);
    f.text("mac", mac,
           {.doc = "destination address; of a stream over `udp` it follows from the group", .required = !stream.udp});
    if (stream.udp) {
        stream.address.destination = stream.udp->from({}, {}).group();
        if (!mac.empty()) {
            f.error("mac", "the stream has `udp` and `mac`", "leave out one of them");
        }
    } else if (auto const parsed = iec61850::Mac::parse(mac)) {
        stream.address.destination = *parsed;
        if (!parsed->is_group()) {
            f.error("mac", fmt::format("'{}' is the address of one station", mac),
                    "streams are sent to a group: the first octet is odd");
        }
    } else if (!mac.empty()) {
        f.error("mac", fmt::format("'{}' is not an Ethernet address", mac),
                "for example \"01:0C:CD:04:00:21\", in quotes");
    }
    std::int64_t app_id = stream.kind == Kind::smv ? 0x4000 : 0x0001, vlan_id = 0, vlan_priority = 4;
    bool tagged = true;
    f.integer("app_id", app_id,
              {.doc = "APPID; 0x4000 for smv and 0x0001 for goose when not given", .min = 0, .max = 0xFFFF});
    f.flag("vlan", tagged, {.doc = "frames carry a 802.1Q tag"});
    f.integer("vlan_id", vlan_id, {.doc = "VLAN; 0: only a priority", .min = 0, .max = 4094});
    f.integer("vlan_priority", vlan_priority, {.doc = "priority of the tag", .min = 0, .max = 7});
    stream.address.app_id = static_cast<std::uint16_t>(app_id);
    if (tagged) {
        stream.address.vlan =
            iec61850::VlanTag{static_cast<std::uint16_t>(vlan_id), static_cast<std::uint8_t>(vlan_priority)};
    }
    f.flag("simulated", stream.address.simulated, {.doc = "S bit: a test set sends this, not the device"});
}

void describe_sampled_values(Fields& f, Stream& s) {
    f.text("sv_id", s.sv_id, {.doc = "of smv: svID", .required = true});
    f.fraction("rate_hz", s.rate_hz, {.doc = "samples per second", .above = 0});
    f.integer("samples_per_frame", s.samples_per_frame,
              {.doc = "consecutive samples (ASDUs) in a frame", .min = 1, .max = 16});
    f.choice<std::uint8_t>(
        "synch", s.smp_synch,
        {{"none", iec61850::kNotSynchronised}, {"local", iec61850::kLocalClock}, {"global", iec61850::kGlobalClock}},
        {.doc = "smpSynch: the clock behind the sample counter"});
    std::int64_t clock_identity = 0;
    f.integer("clock_identity", clock_identity,
              {.doc = "smpSynch of a local clock with an identity, instead of `synch`", .min = 5, .max = 254});
    s.smp_synch = clock_identity != 0 ? static_cast<std::uint8_t>(clock_identity) : s.smp_synch;
    std::string gm_identity;
    f.text("gm_identity", gm_identity,
           {.doc = "identity of the PTP grandmaster, 16 hexadecimal digits; not sent when not given"});
    if (!gm_identity.empty()) {
        std::uint64_t identity = 0;
        auto const [end, ec] =
            std::from_chars(gm_identity.data(), gm_identity.data() + gm_identity.size(), identity, 16);
        if (ec != std::errc{} || end != gm_identity.data() + gm_identity.size() || gm_identity.size() != 16) {
            f.error("gm_identity", fmt::format("'{}' is not the identity of a clock", gm_identity),
                    "16 hexadecimal digits in quotes, like \"001122FFFE334455\"");
        }
        s.gm_identity = identity;
    }
    f.flag("send_refr_tm", s.send_refr_tm, {.doc = "the frame carries the time of its sample"});
    f.flag("send_smp_rate", s.send_smp_rate, {.doc = "the frame carries smpRate and smpMod"});
    if (!s.rate_hz.is_whole() || s.rate_hz > Rational{65536}) {
        f.error("rate_hz", fmt::format("{} samples a second", s.rate_hz.to_string()),
                "smpCnt counts whole samples in a second, at most 65536");
    } else if (s.send_smp_rate && s.rate_hz > Rational{65535}) {
        f.error("send_smp_rate", fmt::format("smpRate cannot say {} samples a second", s.rate_hz.to_string()),
                "it ends at 65535: leave it out, or a lower rate_hz");
    }
}

/// Usual is LD/LLN0$GO$name; but a subscriber has to expect what its device sends.
void check_control_block(Fields& f, std::string const& reference) {
    std::size_t const slash = reference.find('/');
    bool const two_parts = slash != std::string::npos && slash > 0 && slash + 1 < reference.size();
    if (!reference.empty() && (!two_parts || reference.find(' ') != std::string::npos)) {
        f.error("control_block", fmt::format("'{}' is no reference of a control block", reference),
                "LD/LLN0$GO$name without spaces, for example IED2LD0/LLN0$GO$Trip");
    }
}

void describe_goose(Fields& f, Stream& s) {
    using Form = iec61850::IntegerForm;
    GooseTiming& t = s.timing;
    f.text("control_block", s.control_block, {.doc = "of goose: gocbRef, LD/LLN0$GO$name", .required = true});
    check_control_block(f, s.control_block);
    f.text("go_id", s.go_id, {.doc = "goID; not sent when not given"});
    f.number("min_time_ms", t.min_time_ms, {.doc = "from a change to the first repetition", .above = 0});
    f.number("growth", t.growth, {.doc = "each interval is so much longer than the one before", .min = 1});
    f.number("max_time_ms", t.max_time_ms, {.doc = "interval in steady state", .above = 0});
    f.number("live_factor", t.live_factor,
             {.doc = "timeAllowedToLive, in intervals until the next message", .above = 1});
    f.number("live_min_ms", t.live_min_ms,
             {.doc = "timeAllowedToLive is at least this", .min = 0, .max = kLongestLiveMs});
    std::int64_t first_sq_num = 0;
    f.integer("first_sq_num", first_sq_num,
              {.doc = "sqNum of the very first message; conformance tests of Edition 1 want 1", .min = 0, .max = 1});
    s.first_sq_num = static_cast<std::uint32_t>(first_sq_num);
    f.choice<Form>("integers", s.integers, {{"minimal", Form::minimal}, {"fixed", Form::fixed}},
                   {.doc = "length of integers (8-1 Ed.2, annex A)"});
    if (t.max_time_ms < t.min_time_ms) {
        f.error("max_time_ms", fmt::format("it is shorter than min_time_ms ({} ms)", shortest(t.min_time_ms)));
    } else if (t.live_factor * t.max_time_ms > kLongestLiveMs) {
        f.error(f.has("max_time_ms") ? "max_time_ms" : "live_factor",
                fmt::format("timeAllowedToLive would be {} ms: live_factor ({}) times max_time_ms ({})",
                            shortest(t.live_factor * t.max_time_ms), shortest(t.live_factor), shortest(t.max_time_ms)),
                fmt::format("it has 32 bits and ends at {} ms", shortest(kLongestLiveMs)));
    }
}

/// `longest`: octets of its Ethernet frame with the longest values.
void check_datagram(Fields& f, Stream const& stream, std::size_t longest) {
    constexpr std::size_t kLongestApdu = iec61850::kMaxLength - iec61850::kRoutableOverhead;
    std::size_t const before = iec61850::app_id_offset(stream.address) + iec61850::kHeaderOctets;
    if (longest > before + kLongestApdu) {
        f.error("udp", fmt::format("a message of stream '{}' could have {} octets", stream.name.name, longest - before),
                fmt::format("a datagram has room for {}: fewer samples_per_frame or members", kLongestApdu));
    }
    if (stream.authentication) {
        f.error("authentication", fmt::format("stream '{}' goes over UDP", stream.name.name),
                "signatures of sessions are not there yet: leave out one of them");
    }
}

/// That its frames can be made, and hold what is added to them.
void check_frames(Fields& s, Stream const& stream) {
    std::optional<Error> problem;
    std::size_t longest = 0;
    if (stream.kind == Kind::smv) {
        auto const made = stream.sv_template({});
        problem = made ? std::nullopt : std::optional{made.error()};
        longest = made ? made->frame().size() : 0;
        if (made && stream.authentication &&
            made->frame().size() - iec61850::app_id_offset(stream.address) +
                    iec61850::extension_octets(stream.authentication->algorithm) >
                iec61850::kMaxLength) {
            s.error("authentication", fmt::format("stream '{}': there is no room for a code", stream.name.name),
                    fmt::format("a frame has {} octets behind the ethertype: fewer samples_per_frame or members",
                                iec61850::kMaxLength));
        }
    } else {
        auto const made = stream.goose_template({});
        problem = made ? std::nullopt : std::optional{made.error()};
        longest = made ? made->longest_frame() : 0;
    }
    if (stream.udp) {
        check_datagram(s, stream, longest);
    }
    if (problem) {
        s.error("", fmt::format("stream '{}': {}", stream.name.name, problem->message), problem->remedy);
    }
}

/// That a receiver can tell two streams apart.
void check_apart(Fields& s, Stream const& other, Stream const& stream) {
    bool const same =
        !other.broken && other.kind == stream.kind &&
        (stream.kind == Kind::smv ? other.sv_id == stream.sv_id : other.control_block == stream.control_block);
    if (same && other.address.destination == stream.address.destination &&
        other.address.app_id == stream.address.app_id) {
        s.error(
            "",
            fmt::format("streams '{}' and '{}' cannot be told apart on the wire", other.name.name, stream.name.name),
            "another mac, app_id, sv_id or control_block");
    } else if (!other.broken && other.kind == stream.kind &&
               (other.authentication || stream.authentication || other.udp || stream.udp) &&
               other.address.destination == stream.address.destination &&
               other.address.app_id == stream.address.app_id) {
        bool const guarded = other.authentication || stream.authentication;
        s.error(guarded ? "authentication" : "",
                fmt::format("streams '{}' and '{}' have the same Ethernet address and app_id", other.name.name,
                            stream.name.name),
                guarded ? "what is authenticated needs an address of its own"
                        : "a stream over UDP needs an app_id of its own, or a group that differs in its "
                          "last 23 bits");
    }
}

} // namespace

Result<iec61850::SvTemplate> Stream::sv_template(iec61850::Mac source) const {
    iec61850::Address from = address;
    from.source = source;
    iec61850::AsduDescription asdu;
    asdu.sv_id = sv_id;
    asdu.dat_set = data_set_name;
    asdu.conf_rev = conf_rev;
    asdu.smp_synch = smp_synch;
    asdu.refr_tm = send_refr_tm;
    asdu.gm_identity = gm_identity;
    if (send_smp_rate) {
        asdu.smp_rate = static_cast<std::uint16_t>(rate_hz.num());
        asdu.smp_mod = iec61850::SampleMode::per_second;
    }
    asdu.sample_octets = iec61850::SvLayout{data_set}.sample_octets();
    return iec61850::SvTemplate::create(
        from, std::vector<iec61850::AsduDescription>(static_cast<std::size_t>(samples_per_frame), asdu));
}

Result<iec61850::GooseTemplate> Stream::goose_template(iec61850::Mac source) const {
    iec61850::Address from = address;
    from.source = source;
    return iec61850::GooseTemplate::create(from, {control_block, data_set_name, go_id, conf_rev, data_set, integers});
}

std::size_t Stream::longest_payload() const {
    std::size_t longest = 0;
    if (kind == Kind::smv) {
        auto const made = sv_template({});
        longest = made ? made->frame().size() : 0;
    } else {
        auto const made = goose_template({});
        longest = made ? made->longest_frame() : 0;
    }
    if (longest == 0) {
        return 0;
    }
    std::size_t const code = authentication ? iec61850::extension_octets(authentication->algorithm) : 0;
    std::size_t const datagram = udp ? iec61850::kRoutableOverhead - iec61850::kHeaderOctets : 0;
    return longest - iec61850::app_id_offset(address) + code + datagram;
}

void describe(Fields& f, Stream& stream) {
    f.choice<Kind>("kind", stream.kind, {{"smv", Kind::smv}, {"goose", Kind::goose}},
                   {.doc = "sampled values, or GOOSE", .required = true});
    describe_address(f, stream);
    std::int64_t conf_rev = 1;
    f.integer("conf_rev", conf_rev, {.doc = "confRev", .min = 0, .max = 4294967295.0});
    stream.conf_rev = static_cast<std::uint32_t>(conf_rev);
    f.text("data_set_name", stream.data_set_name,
           {.doc = "datSet, LD/LLN0$name; sampled values leave it out when not given"});
    if (stream.kind == Kind::smv) {
        describe_sampled_values(f, stream);
    } else {
        describe_goose(f, stream);
        if (stream.data_set_name.empty()) { // mandatory in GOOSE
            std::size_t const at = stream.control_block.find("$GO$");
            stream.data_set_name = at == std::string::npos
                                       ? stream.control_block
                                       : stream.control_block.substr(0, at) + "$" + stream.name.name;
        }
    }
    describe_data_set(f, stream);
    describe(f, stream.authentication);
}

std::vector<Stream> read_streams(Node const& streams, config::Diagnostics& diagnostics) {
    std::vector<Stream> out;
    if (streams.is_null()) {
        return out;
    }
    Node root = Node::map(streams.where);
    root.set("streams", streams);
    config::read_fields(root, "", diagnostics, [&](Fields& f) {
        f.map("streams", {.doc = "SMV and GOOSE streams"}, [&](Ref const& name, Fields& s) {
            Stream stream;
            stream.name = name;
            int const errors = diagnostics.errors();
            describe(s, stream);
            if (diagnostics.errors() > errors) {
                stream.broken = true;
                out.push_back(std::move(stream));
                return;
            }
            check_frames(s, stream);
            for (Stream const& other : out) {
                check_apart(s, other, stream);
            }
            stream.broken = diagnostics.errors() > errors;
            out.push_back(std::move(stream));
        });
    });
    return out;
}

Stream const* find_stream(std::span<Stream const> streams, std::string_view name) {
    auto const it = std::find_if(streams.begin(), streams.end(), [&](Stream const& s) { return s.name.name == name; });
    return it == streams.end() ? nullptr : &*it;
}

} // namespace gridspace::streams
