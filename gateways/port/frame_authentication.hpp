// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/duration_histogram.hpp"
#include "common/time.hpp"
#include "gateways/iec61850/authentication.hpp"
#include "gateways/streams/stream.hpp"

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::gateways {

/// Findings of authentication among those of the first-line rules: bits that no rule uses.
inline constexpr unsigned kFirstAuthenticityBit = 20;
[[nodiscard]] std::string authenticity_names(std::uint32_t findings);
/// Names of the counters of an authenticated stream.
[[nodiscard]] inline std::vector<std::string> authenticity_counters() {
    std::vector<std::string> out;
    for (std::size_t k = 0; k < iec61850::kAuthenticities; ++k) {
        auto const which = static_cast<iec61850::Authenticity>(k);
        out.push_back("authentication_" + std::string{iec61850::authenticity_name(which)});
    }
    return out;
}

/// Codes on the frames that a process sends, and a judge of those that it receives, for all of its streams that are
/// authenticated. A stream is recognised by ethertype, destination and APPID. Any thread may send, and one may receive.
class FrameAuthentication {
  public:
    using Counters = std::array<std::uint64_t, iec61850::kAuthenticities>;
    using Finding = std::function<void(std::string const& stream, std::uint32_t findings, iec61850::Mac const& source,
                                       SimTime time)>;

    /// Nothing when none of the streams is authenticated. `start_utc_ns`: see load_keys().
    [[nodiscard]] static Result<std::unique_ptr<FrameAuthentication>>
    create(std::vector<streams::Stream> const& streams, std::optional<std::int64_t> start_utc_ns);

    /// The frame as it goes out, in `out`. Without a valid key, or of another stream: as it came.
    [[nodiscard]] iec61850::Octets sign(iec61850::Octets frame, std::int64_t utc_ns, std::vector<std::uint8_t>& out);
    /// Whether a received frame is used.
    [[nodiscard]] bool accept(iec61850::Octets frame, std::int64_t utc_ns, SimTime time);

    /// By Authenticity; nothing for a stream that is not authenticated.
    [[nodiscard]] Counters const* counters(std::string_view stream) const;
    void on_finding(Finding finding) { finding_ = std::move(finding); }

    /// By how much it delayed the frames of its streams that were sent and received, wall time.
    [[nodiscard]] DurationHistogram const& signing() const { return signing_; }
    [[nodiscard]] DurationHistogram const& checking() const { return checking_; }

  private:
    struct Guarded {
        streams::Stream stream;
        iec61850::KeyRing sending, receiving; ///< a key is used by one thread
        iec61850::FrameSigner signer;
        iec61850::FrameVerifier verifier;
        Counters counters{};
        bool told{false};
    };
    [[nodiscard]] Guarded* of(iec61850::FrameHeader const& header);

    std::vector<Guarded> streams_;
    std::mutex signing_now_;
    std::uint64_t counter_{0}; ///< of all frames that are sent: a vector must not be used twice
    DurationHistogram signing_, checking_;
    Finding finding_;
};

} // namespace gridspace::gateways
