// Starts the language server, `mars-asp lsp`, and hands it what is open.

const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

const SOURCES = ["c", "cpp", "go", "java", "matlab", "python", "rust"];

let client;

function activate(context) {
  const settings = workspace.getConfiguration("mars-asp");
  const server = {
    command: settings.get("command"),
    args: ["lsp", ...settings.get("arguments")],
  };
  const watcher = workspace.createFileSystemWatcher("**/{*.mars,*.lp,mars.toml}");
  context.subscriptions.push(watcher);
  client = new LanguageClient("mars-asp", "mars-asp", server, {
    documentSelector: ["mars", "mars-rules", ...SOURCES].map((language) => ({
      scheme: "file",
      language,
    })),
    synchronize: { fileEvents: watcher },
  });
  return client.start();
}

function deactivate() {
  return client && client.stop();
}

module.exports = { activate, deactivate };
