// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/frame_authentication.hpp"

#include "common/log.hpp"
#include "gateways/port/key_file.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace gridspace::gateways {

using iec61850::Authenticity;

namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

} // namespace

std::string authenticity_names(std::uint32_t findings) {
    std::string out;
    for (std::size_t k = 1; k < iec61850::kAuthenticities; ++k) {
        if ((findings >> (kFirstAuthenticityBit + k) & 1U) != 0) {
            out += (out.empty() ? "" : ", ") + std::string{iec61850::authenticity_name(static_cast<Authenticity>(k))};
        }
    }
    return out;
}

Result<std::unique_ptr<FrameAuthentication>> FrameAuthentication::create(std::vector<streams::Stream> const& streams,
                                                                         std::optional<std::int64_t> start_utc_ns) {
    auto out = std::unique_ptr<FrameAuthentication>{};
    for (streams::Stream const& stream : streams) {
        if (!stream.authentication) {
            continue;
        }
        streams::StreamAuthentication const& a = *stream.authentication;
        auto const named = [&](Error const& e) {
            return fail(e.code, fmt::format("stream '{}': {}", stream.name.name, e.message), e.remedy);
        };
        auto const entries = load_keys(a, start_utc_ns);
        if (!entries) {
            return named(entries.error());
        }
        auto sending = iec61850::KeyRing::create(iec61850::code_kind(a.algorithm), *entries);
        auto receiving = iec61850::KeyRing::create(iec61850::code_kind(a.algorithm), *entries);
        if (!sending || !receiving) {
            return named(sending ? receiving.error() : sending.error());
        }
        out = out == nullptr ? std::make_unique<FrameAuthentication>() : std::move(out);
        out->streams_.push_back({stream,
                                 std::move(*sending),
                                 std::move(*receiving),
                                 iec61850::FrameSigner{a.algorithm},
                                 iec61850::FrameVerifier{a.algorithm, static_cast<std::int64_t>(a.max_age_ms * 1e6)},
                                 {},
                                 false});
    }
    return out;
}

FrameAuthentication::Guarded* FrameAuthentication::of(iec61850::FrameHeader const& header) {
    auto const found = std::find_if(streams_.begin(), streams_.end(), [&](Guarded const& g) {
        return g.stream.ethertype() == header.ethertype && g.stream.address.app_id == header.app_id &&
               g.stream.address.destination == header.destination;
    });
    return found == streams_.end() ? nullptr : &*found;
}

iec61850::Octets FrameAuthentication::sign(iec61850::Octets frame, std::int64_t utc_ns,
                                           std::vector<std::uint8_t>& out) {
    iec61850::FrameHeader header;
    Guarded* const guarded = iec61850::decode_header(frame, header) ? of(header) : nullptr;
    if (guarded == nullptr) {
        return frame;
    }
    auto const begin = Clock::now();
    std::lock_guard const alone{signing_now_};
    iec61850::Octets const with_code = guarded->signer.sign(frame, guarded->sending, utc_ns, counter_);
    out.assign(with_code.begin(), with_code.end());
    signing_.add(nanoseconds_since(begin));
    if (out.empty() && !std::exchange(guarded->told, true)) {
        log::warning("stream '{}': no key is valid now, or the frame is too long: frames go out without a code",
                     guarded->stream.name.name);
    }
    return out.empty() ? frame : iec61850::Octets{out};
}

bool FrameAuthentication::accept(iec61850::Octets frame, std::int64_t utc_ns, SimTime time) {
    iec61850::FrameHeader header;
    Guarded* const guarded = iec61850::decode_header(frame, header) ? of(header) : nullptr;
    if (guarded == nullptr) {
        return true;
    }
    auto const begin = Clock::now();
    Authenticity const found = guarded->verifier.judge(frame, guarded->receiving, utc_ns);
    checking_.add(nanoseconds_since(begin));
    ++guarded->counters[static_cast<std::size_t>(found)];
    if (found == Authenticity::genuine) {
        return true;
    }
    if (finding_) {
        finding_(guarded->stream.name.name, 1U << (kFirstAuthenticityBit + static_cast<unsigned>(found)), header.source,
                 time);
    }
    return !guarded->stream.authentication->required;
}

FrameAuthentication::Counters const* FrameAuthentication::counters(std::string_view stream) const {
    auto const found =
        std::find_if(streams_.begin(), streams_.end(), [&](Guarded const& g) { return g.stream.name.name == stream; });
    return found == streams_.end() ? nullptr : &found->counters;
}

} // namespace gridspace::gateways
