// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/key_file.hpp"

#include "gateways/iec61850/octets.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::gateways {
namespace {

constexpr std::size_t kLargestFile = 1U << 20U;

Result<std::string> read_secret_file(std::string const& path) {
    int const fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd < 0) {
        return fail(ExitCode::usage, fmt::format("key file {}: {}", path, std::strerror(errno)),
                    "make it with: (umask 077; echo \"1 $(openssl rand -hex 32)\" > FILE)");
    }
    struct stat about{};
    std::string text;
    std::optional<std::string> problem;
    if (::fstat(fd, &about) != 0 || !S_ISREG(about.st_mode)) {
        problem = "it is no regular file";
    } else if ((about.st_mode & 077U) != 0) {
        problem = fmt::format("others may read or write it (mode {:04o})", about.st_mode & 07777U);
    } else if (static_cast<std::size_t>(about.st_size) > kLargestFile) {
        problem = "it is larger than 1 MiB";
    } else {
        text.resize(static_cast<std::size_t>(about.st_size));
        auto const got = ::read(fd, text.data(), text.size());
        problem = got == about.st_size ? std::nullopt : std::optional{std::string{"it cannot be read"}};
    }
    ::close(fd);
    if (problem) {
        return fail(ExitCode::usage, fmt::format("key file {}: {}", path, *problem), fmt::format("chmod 600 {}", path));
    }
    return text;
}

Result<std::vector<iec61850::KeyEntry>> key_of_name(std::string const& name) {
    auto code = crypto::MessageCode::create(crypto::CodeKind::hmac_sha256,
                                            iec61850::octets_of("Gridspace: a key that is no secret"));
    if (!code) {
        return std::unexpected{code.error()};
    }
    crypto::MessageCode::Code secret;
    std::array<std::uint8_t, crypto::kVectorOctets> const unused{};
    if (!code->compute(iec61850::octets_of(name), unused, secret)) {
        return fail(ExitCode::environment, "OpenSSL computes no HMAC");
    }
    iec61850::KeyEntry key;
    key.id = 1;
    key.secret.assign(secret.begin(), secret.end());
    return std::vector{key};
}

} // namespace

Result<std::vector<iec61850::KeyEntry>> load_keys(streams::StreamAuthentication const& authentication,
                                                  std::optional<std::int64_t> start_utc_ns) {
    if (authentication.key_file.empty()) {
        return key_of_name(authentication.key_name);
    }
    std::string const path = authentication.key_file.string();
    auto text = read_secret_file(path);
    if (!text) {
        return std::unexpected{text.error()};
    }
    auto keys = iec61850::parse_keys(*text, path, start_utc_ns);
    crypto::wipe({reinterpret_cast<std::uint8_t*>(text->data()), text->size()});
    return keys;
}

} // namespace gridspace::gateways
