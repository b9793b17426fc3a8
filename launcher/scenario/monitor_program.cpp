// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/monitor_program.hpp"

#include "launcher/scenario/monitor_settings.hpp"
#include "launcher/scenario/own_topics.hpp"
#include "launcher/scenario/scenario.hpp"
#include "monitor/web/listening.hpp"

#include <filesystem>

namespace gridspace::launcher {
namespace {

using config::Fields;
using config::Node;
using config::Ref;

class MonitorSettings final : public ProcessSettings {
  public:
    static std::unique_ptr<ProcessSettings> read(Fields& f) {
        auto out = std::make_unique<MonitorSettings>();
        f.text(
            "listen", out->listen_,
            {.doc =
                 "address and port of the dashboard; port 0: a free one, printed. Elsewhere than 127.0.0.1 only with a "
                 "token and TLS"});
        f.references("allow_hosts", out->allow_hosts_,
                     {.doc = "names beyond localhost and the address under which it may be reached"});
        f.file(
            "token_file", out->token_file_,
            {.doc =
                 "file with the secret of whoever may look at the run: a line of at least 16 characters, mode 0600"});
        f.file("tls_cert", out->tls_cert_, {.doc = "its certificate, with those that vouch for it (PEM)"});
        f.file("tls_key", out->tls_key_, {.doc = "key of the certificate (PEM)"});
        f.file("idl", out->idl_, {.doc = "IDL of foreign types, which nobody publishes on type_catalog"});
        if (out->tls_cert_.empty() != out->tls_key_.empty()) {
            f.error(out->tls_cert_.empty() ? "tls_key" : "tls_cert", "a certificate goes with its key",
                    "give tls_cert and tls_key");
        } else if (auto ok = web::check_exposure(out->listen_, !out->token_file_.empty(), !out->tls_cert_.empty());
                   !ok) {
            f.error("listen", ok.error().message, ok.error().remedy);
        }
        return out;
    }
    [[nodiscard]] bool is_member() const override { return false; }
    [[nodiscard]] bool is_expected() const override { return false; }
    [[nodiscard]] std::string listen() const override { return listen_; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = own_settings(process);
        for (auto const& [key, file] : {std::pair{"token_file", &token_file_}, std::pair{"tls_cert", &tls_cert_},
                                        std::pair{"tls_key", &tls_key_}, std::pair{"idl", &idl_}}) {
            if (!file->empty()) {
                node.set(key, Node::quoted_text(std::filesystem::absolute(*file).string()));
            }
        }
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
    std::string listen_{"127.0.0.1:0"};
    std::vector<Ref> allow_hosts_;
    std::filesystem::path token_file_, tls_cert_, tls_key_, idl_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_monitor(Fields& f) {
    return MonitorSettings::read(f);
}

} // namespace gridspace::launcher
