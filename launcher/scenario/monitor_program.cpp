// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/monitor_program.hpp"

#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/monitor_settings.hpp"
#include "launcher/scenario/own_topics.hpp"
#include "launcher/scenario/scenario.hpp"
#include "monitor/app/access_config.hpp"
#include "monitor/web/listening.hpp"

namespace gridspace::launcher {
namespace {

using config::Fields;
using config::Node;

class MonitorSettings final : public DeclaredSettings {
  public:
    explicit MonitorSettings(Fields& f) : DeclaredSettings{monitor::monitor_declaration()} {
        describe(f, access_);
        if (access_.tls_cert.empty() != access_.tls_key.empty()) {
            f.error(access_.tls_cert.empty() ? "tls_key" : "tls_cert", "a certificate goes with its key",
                    "give tls_cert and tls_key");
        } else if (auto ok =
                       web::check_exposure(access_.listen, !access_.token_file.empty(), !access_.tls_cert.empty());
                   !ok) {
            f.error("listen", ok.error().message, ok.error().remedy);
        }
    }
    void check(Scenario const&, Process const&, config::Diagnostics&) override {} // files may come before it starts
    [[nodiscard]] std::string listen() const override { return access_.listen; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = DeclaredSettings::settings(s, process);
        if (auto const own = own_types(s); !own.empty()) {
            Node types = Node::sequence();
            for (auto const& [type, file] : own) {
                Node entry = Node::map();
                entry.set("name", Node::quoted_text(type));
                entry.set("idl", Node::quoted_text(file.string()));
                types.items.push_back(std::move(entry));
            }
            node.set("types", std::move(types));
        }
        node.set("scenario", Node::quoted_text(s.name));
        node.set("run", monitored_run(s, ".."));
        return node;
    }

  private:
    monitor::AccessConfig access_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_monitor(Fields& f) {
    return std::make_unique<MonitorSettings>(f);
}

} // namespace gridspace::launcher
