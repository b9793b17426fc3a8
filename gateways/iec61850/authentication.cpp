// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/authentication.hpp"

#include <algorithm>

namespace gridspace::iec61850 {
namespace {

constexpr std::uint8_t kAuthenticationTag = 0x85, kVersion = 1;
constexpr std::int64_t kMicrosecond = 1000, kSecond = 1'000'000'000;
constexpr std::uint64_t kWindow = 1'000'000; ///< microseconds that a frame may be overtaken by

/// Where things stand in the element, from its tag on.
enum At : std::size_t {
    at_value = 2,
    at_version = at_value,
    at_key_time = at_version + 1,
    at_next_key = at_key_time + 4,
    at_sender = at_next_key + 2,
    at_counter = at_sender + 4,
    at_key_id = at_counter + 8,
    at_code = at_key_id + 4,
};
static_assert(at_code == at_value + kAuthenticationFields);

std::uint32_t seconds_of(std::int64_t ns) {
    return ns <= 0 ? 0 : static_cast<std::uint32_t>(std::min<std::int64_t>(ns / kSecond, 0xFFFFFFFF));
}

std::uint16_t minutes_until(std::int64_t ns, std::int64_t now_ns) {
    constexpr std::int64_t kMost = 0x7FFF;
    return ns == std::numeric_limits<std::int64_t>::max()
               ? std::uint16_t{0x7FFF}
               : static_cast<std::uint16_t>(std::min<std::int64_t>((ns - now_ns) / (60 * kSecond), kMost));
}

} // namespace

std::size_t extension_octets(CodeAlgorithm algorithm) noexcept {
    return at_code + code_octets(algorithm);
}

std::string_view authenticity_name(Authenticity a) noexcept {
    constexpr std::array<std::string_view, kAuthenticities> kNames{
        "genuine", "untagged", "malformed", "unknown_key", "invalid_key", "wrong_code", "replayed", "out_of_time"};
    return kNames[static_cast<std::size_t>(a)];
}

Octets FrameSigner::sign(Octets frame, KeyRing& keys, std::int64_t utc_ns, std::uint64_t& counter) {
    FrameHeader header;
    KeyRing::Key* const key = keys.to_send_with(utc_ns);
    std::size_t const extension = extension_octets(algorithm_);
    if (key == nullptr || !decode_header(frame, header) || header.length + extension > kMaxLength) {
        return {};
    }
    std::size_t const end = header.apdu_offset + header.apdu.size(), app_id = header.apdu_offset - kHeaderOctets;
    out_.assign(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(end));
    out_.resize(end + extension);
    std::uint8_t* const data = out_.data();
    store_be(data + app_id + 4, static_cast<std::uint16_t>((header.reserved1 & ~kExtensionLengthBits) | extension));
    counter = std::max(counter + 1, static_cast<std::uint64_t>(std::max<std::int64_t>(utc_ns, 0) / kMicrosecond));
    std::uint8_t* const element = data + end;
    element[0] = kAuthenticationTag;
    element[1] = static_cast<std::uint8_t>(extension - at_value);
    element[at_version] = kVersion;
    store_be(element + at_key_time, seconds_of(key->from_ns));
    store_be(element + at_next_key, minutes_until(keys.next_change_ns(utc_ns), utc_ns));
    std::copy_n(header.source.octets.begin() + 2, 4, element + at_sender);
    store_be(element + at_counter, counter);
    store_be(element + at_key_id, key->id);
    crypto::MessageCode::Code code;
    Octets const covered{data + app_id - 2, static_cast<std::size_t>(element + at_code - (data + app_id - 2))};
    if (!key->code.compute(covered, crypto::MessageCode::Vector{element + at_sender, crypto::kVectorOctets}, code)) {
        return {};
    }
    std::copy_n(code.begin(), code_octets(algorithm_), element + at_code);
    return out_;
}

Authenticity FrameVerifier::judge(Octets frame, KeyRing& keys, std::int64_t utc_ns) {
    FrameHeader header;
    if (!decode_header(frame, header)) {
        return Authenticity::malformed;
    }
    std::size_t const extension = header.reserved1 & kExtensionLengthBits;
    std::size_t const end = header.apdu_offset + header.apdu.size();
    if (extension == 0) {
        return Authenticity::untagged;
    }
    std::uint8_t const* const element = frame.data() + end;
    if (extension != extension_octets(algorithm_) || extension > frame.size() - end ||
        element[0] != kAuthenticationTag || element[1] != extension - at_value || element[at_version] != kVersion) {
        return Authenticity::malformed;
    }
    KeyRing::Key* const key = keys.find(load_be<std::uint32_t>(element + at_key_id));
    if (key == nullptr) {
        return Authenticity::unknown_key;
    }
    if (!key->valid(utc_ns)) {
        return Authenticity::invalid_key;
    }
    std::uint8_t const* const from = frame.data() + header.apdu_offset - kHeaderOctets - 2;
    Octets const covered{from, static_cast<std::size_t>(element + at_code - from)};
    crypto::MessageCode::Code code;
    std::size_t const octets = code_octets(algorithm_);
    if (!key->code.compute(covered, crypto::MessageCode::Vector{element + at_sender, crypto::kVectorOctets}, code) ||
        !crypto::same_octets({code.data(), octets}, {element + at_code, octets})) {
        return Authenticity::wrong_code;
    }
    auto const counter = load_be<std::uint64_t>(element + at_counter);
    auto const now = static_cast<std::uint64_t>(std::max<std::int64_t>(utc_ns, 0) / kMicrosecond);
    std::uint64_t const apart = counter > now ? counter - now : now - counter;
    if (max_age_ns_ != 0 && apart > static_cast<std::uint64_t>(max_age_ns_ / kMicrosecond)) {
        return Authenticity::out_of_time;
    }
    return is_new(load_be<std::uint32_t>(element + at_sender), counter) ? Authenticity::genuine
                                                                        : Authenticity::replayed;
}

bool FrameVerifier::is_new(std::uint32_t name, std::uint64_t counter) {
    auto sender = std::find_if(senders_.begin(), senders_.end(), [&](Sender const& s) { return s.name == name; });
    if (sender == senders_.end()) { // only who has the key gets here
        senders_.push_back({});
        sender = senders_.end() - 1;
        sender->name = name;
        sender->newest = counter;
    } else if (counter > sender->newest) {
        sender->newest = counter;
    } else {
        // What was overtaken is as new as what overtook it, while it can still be told from what was there already.
        if (sender->newest - counter > kWindow || counter <= sender->forgotten ||
            std::find(sender->seen.begin(), sender->seen.end(), counter) != sender->seen.end()) {
            return false;
        }
    }
    sender->forgotten = std::max(sender->forgotten, sender->seen[sender->next]);
    sender->seen[sender->next] = counter;
    sender->next = (sender->next + 1) % sender->seen.size();
    return true;
}

} // namespace gridspace::iec61850
