// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/authentication.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/routable.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/iec61850/sv_template.hpp"
#include "gateways/prp/redundancy_trailer.hpp"
#include "gateways/ptp/time_quality.hpp"
#include "targets.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace gridspace::fuzz {
namespace {

using namespace iec61850;

/// Views must lie inside of what was given.
bool inside(Octets whole, Octets part) {
    return part.empty() || (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size());
}

/// The shortcut for usual frames changes nothing.
void compare_decoders(Octets octets, Decoded<void> const& said, SvFrame const& frame) {
    static auto const other = std::make_unique<SvFrame>();
    auto const again = decode_sv_without_shortcut(octets, *other);
    require(again.has_value() == said.has_value() && (again || again.error() == said.error()),
            "two decoders, two opinions");
    require(!again || (other->count == frame.count && other->secured == frame.secured), "two decoders, two frames");
    for (std::size_t i = 0; again && i < frame.count; ++i) {
        Asdu const &a = frame.asdus[i], &b = other->asdus[i];
        require(a.sv_id == b.sv_id && a.dat_set == b.dat_set && a.sample.data() == b.sample.data() &&
                    a.sample.size() == b.sample.size() && a.refr_tm == b.refr_tm && a.gm_identity == b.gm_identity &&
                    a.conf_rev == b.conf_rev && a.smp_cnt == b.smp_cnt && a.smp_rate == b.smp_rate &&
                    a.smp_mod == b.smp_mod && a.fields == b.fields && a.smp_synch == b.smp_synch &&
                    a.offset == b.offset,
                "two decoders, two samples");
    }
}

void reencode(SvFrame const& frame) {
    std::vector<AsduDescription> asdus;
    for (Asdu const& a : frame.view()) {
        AsduDescription d;
        d.sv_id = a.sv_id;
        d.dat_set = a.dat_set;
        d.conf_rev = a.conf_rev;
        d.smp_synch = a.smp_synch;
        d.refr_tm = a.has(Asdu::refr_tm_field);
        d.sample_octets = a.sample.size();
        asdus.push_back(d);
    }
    auto again = SvTemplate::create(
        {frame.header.destination, frame.header.source, frame.header.vlan, frame.header.app_id, false}, asdus);
    if (!again) {
        return; // strict in writing: more ASDUs, odd characters, no data
    }
    for (std::size_t i = 0; i < asdus.size(); ++i) {
        again->set_smp_cnt(i, frame.asdus[i].smp_cnt);
        std::copy(frame.asdus[i].sample.begin(), frame.asdus[i].sample.end(), again->sample(i).begin());
    }
    auto second = std::make_unique<SvFrame>();
    require(decode_sv(again->frame(), *second).has_value(), "what we wrote cannot be read");
    require(second->count == frame.count, "ASDUs were lost");
    for (std::size_t i = 0; i < asdus.size(); ++i) {
        require(second->asdus[i].smp_cnt == frame.asdus[i].smp_cnt &&
                    std::ranges::equal(second->asdus[i].sample, frame.asdus[i].sample),
                "a sample changed");
    }
}

/// Whatever a frame says, nobody without the key is genuine; and the same frame with a code is, once.
void authenticate(Octets frame) {
    constexpr auto kAlgorithm = CodeAlgorithm::aes_gmac_64;
    static KeyRing keys = [] {
        KeyEntry key;
        key.id = 0x61616161; // what a fuzzer finds
        key.secret.assign(16, 7);
        return std::move(*KeyRing::create(code_kind(kAlgorithm), {key}));
    }();
    FrameVerifier verifier{kAlgorithm, 0};
    require(verifier.judge(frame, keys, 0) != Authenticity::genuine, "genuine without the key");
    FrameSigner signer{kAlgorithm};
    std::uint64_t counter = 0;
    Octets const sent = signer.sign(frame, keys, 0, counter);
    require(sent.empty() || verifier.judge(sent, keys, 0) == Authenticity::genuine, "not genuine with the key");
    require(sent.empty() || verifier.judge(sent, keys, 0) == Authenticity::replayed, "genuine twice");
}

GooseSubscription subscription_of(GooseFrame const& m) {
    GooseSubscription out;
    out.gocb_ref = m.gocb_ref;
    out.conf_rev = m.conf_rev;
    out.data_set = {{DataNode::leaf("a", BasicType::boolean),
                     {"s", DataNode::Kind::structure, {}, 0, {DataNode::leaf("t", BasicType::visible_string)}}}};
    return out;
}

} // namespace

void require(bool ok, char const* what) {
    if (!ok) {
        std::fprintf(stderr, "fuzz: %s\n", what);
        std::abort();
    }
}

void sv(std::uint8_t const* data, std::size_t size) {
    static auto const frame = std::make_unique<SvFrame>();
    Octets const octets{data, size};
    authenticate(octets);
    auto const ok = decode_sv(octets, *frame);
    compare_decoders(octets, ok, *frame);
    if (!ok) {
        require(ok.error().reason != Reason::none && ok.error().offset <= size, "an error without a reason or a place");
        return;
    }
    SvSubscription s;
    s.wrap = 0;
    SvSubscriber subscriber{s};
    SvLayout const layout{data_set_92le()};
    std::int64_t time = 0;
    for (Asdu const& asdu : frame->view()) {
        require(inside(octets, asdu.sample) && inside(octets, octets_of(asdu.sv_id)) &&
                    inside(octets, octets_of(asdu.dat_set)),
                "a view outside");
        subscriber.receive(frame->header, asdu, time += 208'333);
        if (asdu.sample.size() == layout.sample_octets()) {
            for (std::size_t i = 0; i < layout.slots().size(); ++i) {
                (void)to_string(layout.read(i, asdu.sample));
            }
        }
    }
    reencode(*frame);
}

void goose(std::uint8_t const* data, std::size_t size) {
    Octets const octets{data, size};
    authenticate(octets);
    GooseFrame message;
    auto const ok = decode_goose(octets, message);
    if (!ok) {
        require(ok.error().reason != Reason::none && ok.error().offset <= size, "an error without a reason or a place");
        return;
    }
    require(inside(octets, message.all_data) && inside(octets, octets_of(message.gocb_ref)), "a view outside");
    GooseSubscriber subscriber{subscription_of(message)};
    subscriber.receive(message, 0);
    subscriber.receive(message, 1);
    subscriber.expire(INT64_MAX);
    (void)subscriber.value(0);
}

void prp(std::uint8_t const* data, std::size_t size) {
    Octets const frame{data, size};
    auto const trailer = gridspace::prp::trailer_of(frame);
    if (!trailer) {
        return;
    }
    std::vector<std::uint8_t> again;
    gridspace::prp::write_with_trailer(frame.first(size - gridspace::prp::kTrailerOctets), *trailer, again);
    require(gridspace::prp::trailer_of(again) == trailer, "another trailer is read than was written");
}

void ptp(std::uint8_t const* data, std::size_t size) {
    auto const response = gridspace::ptp::decode_response({data, size}, 0);
    require(!response || response->time_status.has_value() != response->parent.has_value(),
            "an answer to two questions");
    gridspace::ptp::TimeQuality quality{{}};
    for (std::int64_t now_ns = 0; response && now_ns < 10; ++now_ns) {
        quality.hear(*response, now_ns);
        (void)quality.look(now_ns);
        require(quality.smp_synch() == 0, "half of what has to be known is enough");
    }
}

void routable(std::uint8_t const* data, std::size_t size) {
    static auto const frame = std::make_unique<RoutableFrame>();
    Octets const octets{data, size};
    require(inside(octets, routable_payload(octets)), "a view outside");
    require(stream_ethertype(octets) == ethertype_of(octets) || !routable_payload(octets).empty(),
            "a session elsewhere");
    if (auto const ok = decode_routable(octets, *frame); !ok) {
        require(ok.error().reason != Reason::none && ok.error().offset <= size, "an error without a reason or a place");
        return;
    }
    require(inside(octets, frame->signature) && inside(octets, frame->session.initialisation_vector), "a view outside");
    for (RoutablePayload const& payload : frame->view()) {
        require(inside(octets, payload.apdu), "a view outside");
        auto const wrapped = as_ethernet({}, {}, payload);
        payload.goose ? goose(wrapped.data(), wrapped.size()) : sv(wrapped.data(), wrapped.size());
    }
    auto const again = encode_routable(frame->session, frame->view());
    auto const second = std::make_unique<RoutableFrame>();
    require(decode_routable(again, *second).has_value() && second->count == frame->count &&
                second->session.spdu_number == frame->session.spdu_number,
            "what we wrote cannot be read");
    for (std::size_t i = 0; i < frame->count; ++i) {
        require(std::ranges::equal(second->payloads[i].apdu, frame->payloads[i].apdu) &&
                    second->payloads[i].app_id == frame->payloads[i].app_id,
                "a message changed");
    }
}

void ber(std::uint8_t const* data, std::size_t size) {
    DataWalker walker{{data, size}, 0};
    Tlv element;
    std::size_t elements = 0;
    while (walker.next(element)) {
        require(++elements <= size && inside({data, size}, element.value),
                "the walk does not end, or leaves the frame");
        for (std::size_t type = 0; type < kBasicTypes; ++type) {
            if (auto const value =
                    is_container(element.tag) ? std::nullopt : read_data_value(element, static_cast<BasicType>(type))) {
                std::uint8_t buffer[4096];
                BerWriter writer{buffer};
                write_data_value(writer, *value, IntegerForm::minimal);
                BerCursor cursor{Octets{buffer, writer.size()}, 0};
                Tlv again;
                require(!writer.ok() ||
                            (cursor.next(again) == Reason::none && read_data_value(again, value->type) == value),
                        "a value changed");
            }
        }
        if (auto const value = read_any_data_value(element)) {
            (void)to_string(*value);
        }
    }
}

} // namespace gridspace::fuzz
