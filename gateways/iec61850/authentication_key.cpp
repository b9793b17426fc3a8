// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/authentication_key.hpp"

#include "common/time.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

constexpr double kLongestSeconds = 1e9; // thirty years: what is more was not meant as simulated time

std::optional<std::int64_t> time_of(std::string_view text, std::optional<std::int64_t> start_utc_ns) {
    double seconds = 0;
    auto const [stop, ec] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (ec == std::errc{} && stop == text.data() + text.size() && std::abs(seconds) <= kLongestSeconds) {
        return start_utc_ns ? std::optional{*start_utc_ns + std::llround(seconds * 1e9)} : std::nullopt;
    }
    auto const utc_s = parse_utc(text);
    return utc_s ? std::optional{*utc_s * 1'000'000'000} : std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> out;
    line = line.substr(0, line.find('#'));
    while (true) {
        std::size_t const begin = line.find_first_not_of(" \t\r");
        if (begin == std::string_view::npos) {
            return out;
        }
        line.remove_prefix(begin);
        std::size_t const end = std::min(line.find_first_of(" \t\r"), line.size());
        out.push_back(line.substr(0, end));
        line.remove_prefix(end);
    }
}

std::optional<std::vector<std::uint8_t>> secret_of(std::string_view text) {
    std::vector<std::uint8_t> out;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        std::uint8_t octet = 0;
        auto const [stop, ec] = std::from_chars(text.data() + i, text.data() + i + 2, octet, 16);
        if (ec != std::errc{} || stop != text.data() + i + 2) {
            return std::nullopt;
        }
        out.push_back(octet);
    }
    return text.size() % 2 == 0 ? std::optional{std::move(out)} : std::nullopt;
}

/// What is wrong with a line, or its key.
std::expected<KeyEntry, std::string> key_of(std::vector<std::string_view> const& words,
                                            std::optional<std::int64_t> start_utc_ns) {
    KeyEntry out;
    auto const [stop, ec] = std::from_chars(words[0].data(), words[0].data() + words[0].size(), out.id);
    if (ec != std::errc{} || stop != words[0].data() + words[0].size() || out.id == 0) {
        return std::unexpected{fmt::format("'{}' is no key id: expected 1 to 4294967295", words[0])};
    }
    auto secret = words.size() < 2 ? std::nullopt : secret_of(words[1]);
    if (!secret || secret->size() < 16 || secret->size() > 64) {
        return std::unexpected{std::string{"expected a secret of 32 to 128 hexadecimal digits after the key id"}};
    }
    out.secret = std::move(*secret);
    for (std::string_view const word : std::span{words}.subspan(2)) {
        bool const from = word.starts_with("from="), until = word.starts_with("until=");
        auto const time =
            from || until ? time_of(word.substr(word.find('=') + 1), start_utc_ns) : std::optional<std::int64_t>{};
        if (!time) {
            return std::unexpected{fmt::format(
                "'{}': expected from=TIME or until=TIME, like 2026-11-24T05:00:00Z{}", word,
                start_utc_ns ? " or in seconds of simulated time" : "; seconds of simulated time need lockstep")};
        }
        (from ? out.from_ns : out.until_ns) = *time;
    }
    if (out.from_ns >= out.until_ns) {
        return std::unexpected{std::string{"the key ends before it begins"}};
    }
    return out;
}

} // namespace

std::size_t code_octets(CodeAlgorithm algorithm) noexcept {
    switch (algorithm) {
    case CodeAlgorithm::hmac_sha256_80:
        return 10;
    case CodeAlgorithm::hmac_sha256_128:
        return 16;
    case CodeAlgorithm::hmac_sha256_256:
        return 32;
    case CodeAlgorithm::aes_gmac_64:
        return 8;
    case CodeAlgorithm::aes_gmac_128:
        return 16;
    }
    return 0;
}

crypto::CodeKind code_kind(CodeAlgorithm algorithm) noexcept {
    return algorithm == CodeAlgorithm::aes_gmac_64 || algorithm == CodeAlgorithm::aes_gmac_128
               ? crypto::CodeKind::aes_gmac
               : crypto::CodeKind::hmac_sha256;
}

Result<std::vector<KeyEntry>> parse_keys(std::string_view text, std::string_view file,
                                         std::optional<std::int64_t> start_utc_ns) {
    std::vector<KeyEntry> out;
    for (std::size_t line = 1; !text.empty(); ++line) {
        std::size_t const end = std::min(text.find('\n'), text.size());
        auto const words = words_of(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (words.empty()) {
            continue;
        }
        auto key = key_of(words, start_utc_ns);
        if (key && std::any_of(out.begin(), out.end(), [&](KeyEntry const& other) { return other.id == key->id; })) {
            key = std::unexpected{fmt::format("key id {} is there twice", key->id)};
        }
        if (!key) {
            return fail(ExitCode::usage, fmt::format("{}:{}: {}", file, line, key.error()),
                        "a line is: ID SECRET [from=TIME] [until=TIME]");
        }
        out.push_back(std::move(*key));
    }
    if (out.empty()) {
        return fail(ExitCode::usage, fmt::format("{}: there is no key in it", file),
                    "a line is: ID SECRET [from=TIME] [until=TIME]");
    }
    return out;
}

Result<KeyRing> KeyRing::create(crypto::CodeKind kind, std::vector<KeyEntry> const& entries) {
    KeyRing out;
    for (KeyEntry const& entry : entries) {
        auto code = crypto::MessageCode::create(kind, entry.secret);
        if (!code) {
            return fail(code.error().code, fmt::format("key {}: {}", entry.id, code.error().message),
                        code.error().remedy);
        }
        out.keys_.push_back({entry.id, entry.from_ns, entry.until_ns, std::move(*code)});
    }
    std::stable_sort(out.keys_.begin(), out.keys_.end(),
                     [](Key const& a, Key const& b) { return a.from_ns < b.from_ns; });
    return out;
}

KeyRing::Key* KeyRing::find(std::uint32_t id) noexcept {
    auto const key = std::find_if(keys_.begin(), keys_.end(), [&](Key const& k) { return k.id == id; });
    return key == keys_.end() ? nullptr : &*key;
}

KeyRing::Key* KeyRing::to_send_with(std::int64_t utc_ns) noexcept {
    auto const key = std::find_if(keys_.rbegin(), keys_.rend(), [&](Key const& k) { return k.valid(utc_ns); });
    return key == keys_.rend() ? nullptr : &*key;
}

std::int64_t KeyRing::next_change_ns(std::int64_t utc_ns) const noexcept {
    auto const key = std::find_if(keys_.begin(), keys_.end(), [&](Key const& k) { return k.from_ns > utc_ns; });
    return key == keys_.end() ? std::numeric_limits<std::int64_t>::max() : key->from_ns;
}

} // namespace gridspace::iec61850
