{
  description = "isoslice, a slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh";

  # nixos-26.05 is the first release with the Rust that fidget needs (1.95).
  inputs.nixpkgs.url = "github:NixOS/nixpkgs/nixos-26.05";

  outputs =
    { self, nixpkgs }:
    let
      systems = [
        "x86_64-linux"
        "aarch64-linux"
        "x86_64-darwin"
        "aarch64-darwin"
      ];
      forAllSystems =
        f: nixpkgs.lib.genAttrs systems (system: f nixpkgs.legacyPackages.${system});

      cargo = builtins.fromTOML (builtins.readFile ./Cargo.toml);
      manifest = cargo.package;
      rustVersion = cargo.workspace.package.rust-version;

      isoslice =
        pkgs:
        pkgs.rustPlatform.buildRustPackage {
          pname = manifest.name;
          version = manifest.version;
          # Says so before anything is built, if a pinned nixpkgs is too old.
          src =
            assert pkgs.lib.assertMsg (pkgs.lib.versionAtLeast pkgs.rustc.version rustVersion)
              "isoslice needs Rust ${rustVersion}, and this nixpkgs has ${pkgs.rustc.version}: nix flake update";
            self;
          # Every crate comes from the lock file with its checksum: the build
          # itself needs no network.
          cargoLock.lockFile = ./Cargo.lock;
          # The tests are a check of their own.
          doCheck = false;
          meta = {
            description = manifest.description;
            license = [
              pkgs.lib.licenses.mit
              pkgs.lib.licenses.asl20
            ];
            mainProgram = "isoslice";
          };
        };

      # The package with another build phase, and nothing to install.
      check =
        pkgs: name: tools: command:
        (isoslice pkgs).overrideAttrs (old: {
          pname = "isoslice-${name}";
          nativeBuildInputs = (old.nativeBuildInputs or [ ]) ++ tools;
          buildPhase = command;
          installPhase = "touch $out";
        });
    in
    {
      packages = forAllSystems (pkgs: {
        default = isoslice pkgs;
      });

      apps = forAllSystems (pkgs: {
        default = {
          type = "app";
          program = "${isoslice pkgs}/bin/isoslice";
        };
      });

      devShells = forAllSystems (pkgs: {
        default = pkgs.mkShell {
          inputsFrom = [ (isoslice pkgs) ];
          packages = [
            pkgs.clippy
            pkgs.rustfmt
            pkgs.rust-analyzer
            pkgs.cargo-deny
            pkgs.cargo-insta
          ];
        };
      });

      checks = forAllSystems (pkgs: {
        fmt = check pkgs "fmt" [ pkgs.rustfmt ] "cargo fmt --all --check";
        clippy =
          check pkgs "clippy" [ pkgs.clippy ]
            "cargo clippy --offline --locked --all-targets -- -D warnings";
        test = check pkgs "test" [ ] "cargo test --release --offline --locked";
      });
    };
}
