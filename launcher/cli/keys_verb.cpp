// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace keys`: authorities and identities for runs with `security:`.
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/security/key_folder.hpp"

#include <algorithm>
#include <ctime>
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace gridspace::cli {
namespace {

using launcher::KeyFolder;

/// QoS roles of what a run starts: a process without an identity of its own takes that of its role.
std::vector<std::string> roles() {
    return {"attacker", "breaker",      "ev_agent", "gateway", "mcca",     "member",
            "monitor",  "merging_unit", "recorder", "relay",   "simulator"};
}

struct KeysArguments {
    std::filesystem::path folder;
    std::vector<std::string> names;
    std::optional<std::int64_t> days; ///< a year, or as long as the authority
    std::string until;
};

/// A day back: clocks of other machines may be slow.
Result<crypto::Validity> validity(KeysArguments const& a) {
    constexpr std::int64_t kDay = 24 * 3600;
    std::int64_t const now = std::time(nullptr);
    std::int64_t until = now + a.days.value_or(365) * kDay;
    if (!a.until.empty()) {
        auto const parsed = parse_utc(a.until);
        if (!parsed) {
            return fail(ExitCode::usage, fmt::format("'{}' is not a UTC time from 1970 to 2199", a.until),
                        "for example 2027-01-31T00:00:00Z");
        }
        until = *parsed;
    }
    return crypto::Validity{std::min(now, until) - kDay, until};
}

int init(KeysArguments const& a) {
    auto const valid = validity(a);
    if (!valid) {
        return print_error(valid.error());
    }
    auto const made = KeyFolder::init(a.folder, a.names.empty() ? roles() : a.names, *valid);
    if (!made) {
        return print_error(made.error());
    }
    fmt::print("{}: two authorities, and {} identities that are valid until {}\n", a.folder.string(),
               a.names.empty() ? roles().size() : a.names.size(), format_utc(valid->until_unix_s));
    fmt::print("in a scenario: security: {{keys: {}}}\n", a.folder.string());
    return 0;
}

int with_folder(KeysArguments const& a, std::function<Result<void>(KeyFolder const&, crypto::Validity)> const& act) {
    auto const valid = validity(a);
    if (!valid) {
        return print_error(valid.error());
    }
    auto const folder = KeyFolder::open(a.folder);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const done = act(*folder, *valid);
    return done ? 0 : print_error(done.error());
}

int issue(KeysArguments const& a) {
    return with_folder(a, [&](KeyFolder const& folder, crypto::Validity valid) -> Result<void> {
        if (auto const end = folder.ends_unix_s(); end && *end > std::time(nullptr) && !a.days && a.until.empty()) {
            valid.until_unix_s = std::min(valid.until_unix_s, *end);
        }
        for (std::string const& name : a.names) {
            if (auto ok = folder.issue(name, valid); !ok) {
                return ok;
            }
            fmt::print("{}: valid until {}\n", name, format_utc(valid.until_unix_s));
        }
        return {};
    });
}

int revoke(KeysArguments const& a) {
    return with_folder(a, [&](KeyFolder const& folder, crypto::Validity) -> Result<void> {
        std::int64_t const now = std::time(nullptr);
        for (std::string const& name : a.names) {
            if (auto ok = folder.revoke(name, {now - 24 * 3600, now + launcher::kTwentyYears}); !ok) {
                return ok;
            }
            fmt::print("{}: revoked; `gridspace keys issue {} {}` makes a new one\n", name, a.folder.string(), name);
        }
        return {};
    });
}

int list(KeysArguments const& a) {
    return with_folder(a, [&](KeyFolder const& folder, crypto::Validity) -> Result<void> {
        auto const all = folder.list();
        if (!all) {
            return std::unexpected{all.error()};
        }
        std::int64_t const now = std::time(nullptr);
        fmt::print("{:<24}{:<24}{:<12}{}\n", "identity", "valid until", "", "serial");
        for (KeyFolder::Listed const& one : *all) {
            fmt::print("{:<24}{:<24}{:<12}{}\n", one.name, format_utc(one.facts.valid.until_unix_s),
                       one.revoked                          ? "revoked"
                       : now > one.facts.valid.until_unix_s ? "expired"
                       : now < one.facts.valid.from_unix_s  ? "not yet"
                                                            : "",
                       one.facts.serial);
        }
        return {};
    });
}

} // namespace

void add_keys(Command app, Action& action) {
    Command keys = app.add_subcommand("keys", "authorities and identities for scenarios with `security:`");
    keys.require_subcommand();
    auto const verb = [&](char const* name, char const* text, int (*act)(KeysArguments const&), char const* names,
                          bool lasting) {
        auto const a = std::make_shared<KeysArguments>();
        Command one = keys.add_subcommand(name, text);
        one.add_option("DIR", a->folder, "folder of keys").required();
        if (names != nullptr) {
            Option option = one.add_option("NAME", a->names, names);
            if (std::string_view{name} != "init") {
                option.required();
            }
        }
        if (lasting) {
            one.add_option("--days", a->days, "valid so long (365; `issue`: at most as long as the authority)")
                .check(in_range(1, 36500));
            one.add_option("--until", a->until, "valid until this UTC time instead");
        }
        one.callback([a, act, &action] { action = [a, act] { return act(*a); }; });
    };
    verb("init", "make a folder of keys: two authorities, and an identity of each role", init,
         "identities instead of the roles: of processes, by their names", true);
    verb("issue", "make a new identity, in the place of an older one", issue, "a process or a role", true);
    verb("revoke", "refuse the certificate that an identity has, from now on", revoke, "a process or a role", false);
    verb("list", "show the identities", list, nullptr, false);
}

} // namespace gridspace::cli
