// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/security/key_folder.hpp"

#include "common/text.hpp"
#include "common/time.hpp"
#include "common/unique_fd.hpp"
#include "launcher/folder/write_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kLargestFile = 1U << 20U;

/// A regular file of reasonable size, as text; `secret`: which nobody else may read or write.
Result<std::string> read_file(fs::path const& file, bool secret) {
    int const fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (fd < 0) {
        return fail(ExitCode::usage, fmt::format("{}: {}", file.string(), std::strerror(errno)),
                    "`gridspace keys init DIR` makes a folder of keys");
    }
    struct stat about{};
    std::string text, problem, remedy;
    if (::fstat(fd, &about) != 0 || !S_ISREG(about.st_mode) || static_cast<std::size_t>(about.st_size) > kLargestFile) {
        problem = "it is no file of keys";
    } else if (secret && (about.st_mode & 077U) != 0) {
        problem = fmt::format("others may read or write it (mode {:04o})", about.st_mode & 07777U);
        remedy = fmt::format("chmod 600 {}", file.string());
    } else {
        text.resize(static_cast<std::size_t>(about.st_size));
        if (::read(fd, text.data(), text.size()) != about.st_size) {
            problem = "it cannot be read";
        }
    }
    ::close(fd);
    return problem.empty() ? Result<std::string>{std::move(text)}
                           : fail(ExitCode::usage, fmt::format("{}: {}", file.string(), problem), remedy);
}

/// A file that nobody else has ever been able to read, also not for a moment.
Result<void> write_secret(fs::path const& file, std::string const& text) {
    fs::path const fresh = file.string() + ".new";
    ::unlink(fresh.c_str());
    int const fd = ::open(fresh.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    bool const written = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    int const why = errno;
    if (fd >= 0) {
        ::close(fd);
    }
    if (!written || ::rename(fresh.c_str(), file.c_str()) != 0) {
        return fail(ExitCode::environment, fmt::format("cannot write {}: {}", file.string(), std::strerror(why)));
    }
    return {};
}

Result<void> write_identity(fs::path const& certificate, fs::path const& key, crypto::Identity const& identity) {
    auto ok = write_secret(key, identity.key);
    return ok ? replace_file(certificate, identity.certificate) : ok;
}

std::string day(std::int64_t unix_s) {
    return format_utc(unix_s);
}

/// Of an identity: it becomes a file's name and a certificate's.
Result<void> check_name(std::string const& name) {
    bool const good = !name.empty() && name.size() <= crypto::kLongestCommonName && name.front() != '.' &&
                      std::ranges::all_of(name, [](char c) {
                          return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                                 c == '_' || c == '-' || c == '.';
                      });
    return good ? Result<void>{}
                : fail(ExitCode::usage, fmt::format("'{}' cannot be the name of an identity", name),
                       fmt::format("letters, digits, '_', '-' and '.', at most {}", crypto::kLongestCommonName));
}

} // namespace

Result<KeyFolder> KeyFolder::init(fs::path folder, std::vector<std::string> const& names, crypto::Validity valid) {
    std::error_code error;
    KeyFolder out{fs::absolute(folder).lexically_normal()};
    if (fs::exists(out.folder_, error) &&
        (!fs::is_directory(out.folder_, error) || !fs::is_empty(out.folder_, error))) {
        return fail(ExitCode::usage, fmt::format("'{}' exists and is not an empty folder", folder.string()),
                    "keys are never overwritten: name another folder, or remove this one");
    }
    fs::create_directories(out.folder_ / key_files::kIdentities, error);
    if (!error) {
        fs::permissions(out.folder_, fs::perms::owner_all, error);
    }
    if (error) {
        return fail(ExitCode::environment, fmt::format("cannot make '{}': {}", folder.string(), error.message()));
    }
    // Authorities and list outlive the identities: one that has run out is issued again, and nobody else is refused.
    crypto::Validity const lasting{valid.from_unix_s, std::max(valid.until_unix_s, valid.from_unix_s + kTwentyYears)};
    auto identity_ca = crypto::make_authority("identities", lasting);
    auto permissions_ca = crypto::make_authority("permissions", lasting);
    if (!identity_ca || !permissions_ca) {
        return std::unexpected{identity_ca ? permissions_ca.error() : identity_ca.error()};
    }
    out.identity_ca_ = std::move(*identity_ca);
    out.permissions_ca_ = std::move(*permissions_ca);
    auto const list = crypto::revocation_list(out.identity_ca_, {}, lasting);
    if (!list) {
        return std::unexpected{list.error()};
    }
    auto ok = write_identity(out.file(key_files::kIdentityCa), out.file(key_files::kIdentityCaKey), out.identity_ca_);
    if (ok) {
        ok = write_identity(out.file(key_files::kPermissionsCa), out.file(key_files::kPermissionsCaKey),
                            out.permissions_ca_);
    }
    if (ok) {
        ok = replace_file(out.file(key_files::kRevoked), *list);
    }
    for (std::string const& name : names) {
        if (ok) {
            ok = out.issue(name, valid);
        }
    }
    return ok ? Result<KeyFolder>{std::move(out)} : std::unexpected{ok.error()};
}

Result<KeyFolder> KeyFolder::open(fs::path folder) {
    KeyFolder out{fs::absolute(folder).lexically_normal()};
    for (auto const& [name, secret, to] :
         {std::tuple{key_files::kIdentityCa, false, &out.identity_ca_.certificate},
          std::tuple{key_files::kIdentityCaKey, true, &out.identity_ca_.key},
          std::tuple{key_files::kPermissionsCa, false, &out.permissions_ca_.certificate},
          std::tuple{key_files::kPermissionsCaKey, true, &out.permissions_ca_.key}}) {
        auto text = read_file(out.file(name), secret);
        if (!text) {
            return std::unexpected{text.error()};
        }
        *to = std::move(*text);
    }
    return out;
}

Result<std::int64_t> KeyFolder::ends_unix_s() const {
    auto const facts = crypto::facts_of(identity_ca_.certificate);
    return facts ? Result<std::int64_t>{facts->valid.until_unix_s} : std::unexpected{facts.error()};
}

Result<void> KeyFolder::issue(std::string const& name, crypto::Validity valid) const {
    if (auto ok = check_name(name); !ok) {
        return ok;
    }
    auto const end = ends_unix_s();
    if (!end) {
        return std::unexpected{end.error()};
    }
    if (valid.until_unix_s > *end) {
        return fail(ExitCode::usage,
                    fmt::format("an identity until {} would outlive the authority of {}, which ends at {}",
                                day(valid.until_unix_s), folder_.string(), day(*end)),
                    "an earlier --until, or fewer --days; or a new folder: gridspace keys init DIR");
    }
    auto const identity = crypto::issue(identity_ca_, name, valid);
    fs::path const base = folder_ / key_files::kIdentities / name;
    return identity ? write_identity(base.string() + ".pem", base.string() + ".key", *identity)
                    : std::unexpected{identity.error()};
}

Result<std::vector<std::string>> KeyFolder::revoked() const {
    auto const list = read_file(file(key_files::kRevoked), false);
    return list ? crypto::revoked_serials(*list, identity_ca_.certificate) : std::unexpected{list.error()};
}

Result<void> KeyFolder::revoke(std::string const& name, crypto::Validity list_valid) const {
    if (auto ok = check_name(name); !ok) {
        return ok;
    }
    auto const certificate = read_file(folder_ / key_files::kIdentities / (name + ".pem"), false);
    if (!certificate) {
        return std::unexpected{certificate.error()};
    }
    // Two at once would each add to the list that both have read.
    UniqueFd const alone{::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (!alone || ::flock(alone.get(), LOCK_EX) != 0) {
        return fail(ExitCode::environment, fmt::format("cannot lock '{}': {}", folder_.string(), std::strerror(errno)));
    }
    auto const facts = crypto::facts_of(*certificate);
    auto serials = revoked();
    if (!facts || !serials) {
        return std::unexpected{facts ? serials.error() : facts.error()};
    }
    if (std::ranges::find(*serials, facts->serial) == serials->end()) {
        serials->push_back(facts->serial);
    }
    auto const list = crypto::revocation_list(identity_ca_, *serials, list_valid);
    return list ? replace_file(file(key_files::kRevoked), *list) : std::unexpected{list.error()};
}

Result<KeyFolder::Found> KeyFolder::find(std::vector<std::string> const& names, std::int64_t now_unix_s) const {
    Found found;
    std::error_code ignored;
    for (std::string const& name : names) {
        fs::path const base = folder_ / key_files::kIdentities / name;
        if (found.name.empty() && fs::exists(base.string() + ".pem", ignored)) {
            found = {name, base.string() + ".pem", base.string() + ".key", {}};
        }
    }
    if (found.name.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("{} has no identity for '{}'", folder_.string(), join(names, "', nor for '")),
                    fmt::format("gridspace keys issue {} {}", folder_.string(), names.front()));
    }
    auto const certificate = read_file(found.certificate, false);
    auto const key = read_file(found.key, true);
    auto const serials = revoked();
    if (!certificate || !key || !serials) {
        return std::unexpected{!certificate ? certificate.error() : !key ? key.error() : serials.error()};
    }
    auto facts = crypto::facts_of(*certificate);
    if (!facts) {
        return std::unexpected{facts.error()};
    }
    std::string const again = fmt::format("gridspace keys issue {} {}", folder_.string(), found.name);
    std::string const which = fmt::format("the certificate of '{}' ({})", found.name, found.certificate.string());
    if (!crypto::is_signed_by(*certificate, identity_ca_.certificate)) {
        return fail(ExitCode::usage, which + " is not signed by the authority of its folder", again);
    }
    for (crypto::Identity const* authority : {&identity_ca_, &permissions_ca_}) {
        auto const its = crypto::facts_of(authority->certificate);
        if (!its || now_unix_s > its->valid.until_unix_s) {
            return its ? fail(ExitCode::usage,
                              fmt::format("the authority '{}' of {} expired at {}", its->name, folder_.string(),
                                          day(its->valid.until_unix_s)),
                              "a new folder: gridspace keys init DIR")
                       : std::unexpected{its.error()};
        }
    }
    if (now_unix_s > facts->valid.until_unix_s) {
        return fail(ExitCode::usage, fmt::format("{} expired at {}", which, day(facts->valid.until_unix_s)), again);
    }
    if (now_unix_s < facts->valid.from_unix_s) {
        return fail(ExitCode::usage, fmt::format("{} is not valid before {}", which, day(facts->valid.from_unix_s)),
                    "is the clock of this machine right?");
    }
    if (std::ranges::find(*serials, facts->serial) != serials->end()) {
        return fail(ExitCode::usage, which + " is revoked", again);
    }
    found.facts = std::move(*facts);
    return found;
}

Result<std::vector<KeyFolder::Listed>> KeyFolder::list() const {
    auto const serials = revoked();
    if (!serials) {
        return std::unexpected{serials.error()};
    }
    std::vector<Listed> out;
    std::error_code error;
    for (auto const& entry : fs::directory_iterator{folder_ / key_files::kIdentities, error}) {
        if (entry.path().extension() != ".pem") {
            continue;
        }
        auto const certificate = read_file(entry.path(), false);
        auto const facts = certificate ? crypto::facts_of(*certificate) : std::unexpected{certificate.error()};
        if (!facts) {
            return std::unexpected{facts.error()};
        }
        out.push_back(
            {entry.path().stem().string(), *facts, std::ranges::find(*serials, facts->serial) != serials->end()});
    }
    std::ranges::sort(out, {}, &Listed::name);
    return out;
}

} // namespace gridspace::launcher
