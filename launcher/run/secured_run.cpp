// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/secured_run.hpp"

#include "launcher/folder/write_file.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/security/documents.hpp"
#include "launcher/security/key_folder.hpp"
#include "launcher/security/rights.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;

constexpr char kSecurity[] = "security", kOwnKeys[] = "keys";
constexpr std::int64_t kDay = 24 * 3600;

/// The authorities' keys have done their work when identities and documents are signed: nobody joins the run later.
void forget_authorities(KeyFolder const& keys) {
    std::error_code ignored;
    fs::remove(keys.file(key_files::kIdentityCaKey), ignored);
    fs::remove(keys.file(key_files::kPermissionsCaKey), ignored);
}

Result<KeyFolder> keys_of(Scenario const& scenario, fs::path const& folder, crypto::Validity valid) {
    if (!scenario.security->keys.empty()) {
        return KeyFolder::open(scenario.security->keys);
    }
    std::vector<std::string> names;
    for (Process const& process : scenario.processes) {
        names.push_back(process.name.name);
    }
    return KeyFolder::init(folder / kOwnKeys, names, valid);
}

Result<std::string> text_of(fs::path const& file) {
    std::ifstream stream{file};
    std::string text{std::istreambuf_iterator<char>{stream}, {}};
    return stream.good() || !text.empty()
               ? Result<std::string>{std::move(text)}
               : fail(ExitCode::usage, fmt::format("cannot read the QoS profiles '{}'", file.string()));
}

/// For its owner alone.
Result<void> make_empty_folder(fs::path const& folder) {
    std::error_code error;
    fs::remove_all(folder, error);
    fs::create_directories(folder, error);
    fs::permissions(folder, fs::perms::owner_all, error);
    if (error) {
        return fail(ExitCode::environment, fmt::format("cannot make '{}': {}", folder.string(), error.message()));
    }
    return {};
}

/// The identity and the rights of a process, and the profiles that name them.
Result<void> secure_process(Scenario const& scenario, KeyFolder const& keys, fs::path const& folder,
                            std::vector<int> const& domains, std::int64_t now_unix_s, PlannedProcess& planned) {
    Process const& process = *scenario.find_process(planned.name);
    auto const identity = keys.find({planned.name, process.qos.name}, now_unix_s);
    if (!identity) {
        return std::unexpected{identity.error()};
    }
    fs::path const own = folder / planned.name;
    std::error_code error;
    fs::create_directories(own, error);
    auto const rights = crypto::sign_document(
        keys.permissions_authority(),
        permissions(identity->facts.subject, rights_of(scenario, process), domains, identity->facts.valid));
    auto const profiles = text_of(qos_file(process.qos.name));
    if (!rights || !profiles) {
        return std::unexpected{rights ? profiles.error() : rights.error()};
    }
    SecurityFiles const files{keys.file(key_files::kIdentityCa),
                              keys.file(key_files::kPermissionsCa),
                              keys.file(key_files::kRevoked),
                              identity->certificate,
                              identity->key,
                              folder / "governance.p7s",
                              own / "permissions.p7s"};
    auto const secured = secured_profiles(*profiles, files);
    if (!secured) {
        return std::unexpected{secured.error()};
    }
    auto ok = replace_file(files.permissions, *rights);
    if (ok) {
        ok = replace_file(own / "qos.xml", *secured);
    }
    if (!ok) {
        return ok;
    }
    planned.config.find("bus")->set("qos", config::Node::scalar((own / "qos.xml").string()));
    planned.environment["GRIDSPACE_QOS"] = (own / "qos.xml").string();
    return {};
}

} // namespace

Result<void> secure(Scenario const& scenario, RunPlan& plan, std::vector<int> const& domains, std::int64_t now_unix_s) {
    if (!scenario.security) {
        return {};
    }
    fs::path const folder = plan.folder / kSecurity;
    if (auto ok = make_empty_folder(folder); !ok) {
        return ok;
    }
    crypto::Validity const valid{now_unix_s - kDay, now_unix_s + 365 * kDay};
    auto const keys = keys_of(scenario, folder, valid);
    if (!keys) {
        return std::unexpected{keys.error()};
    }
    auto const rules = crypto::sign_document(keys->permissions_authority(), governance(*scenario.security, domains));
    if (!rules) {
        return std::unexpected{rules.error()};
    }
    if (auto ok = replace_file(folder / "governance.p7s", *rules); !ok) {
        return ok;
    }
    for (PlannedProcess& planned : plan.processes) {
        if (auto ok = secure_process(scenario, *keys, folder, domains, now_unix_s, planned); !ok) {
            return ok;
        }
    }
    if (scenario.security->keys.empty()) {
        forget_authorities(*keys);
    }
    return {};
}

void forget_run_keys(fs::path const& run) {
    std::error_code ignored;
    fs::path const identities = run / kSecurity / kOwnKeys / key_files::kIdentities;
    for (auto const& entry : fs::directory_iterator{identities, ignored}) {
        if (entry.path().extension() == ".key") {
            fs::remove(entry.path(), ignored);
        }
    }
}

} // namespace gridspace::launcher
