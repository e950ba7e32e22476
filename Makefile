# The two commands of the README, and the parts they are made of.

CARGO ?= cargo
# Mesa's choice among several GPUs asks a display for its opinion, and complains where there is none.
export NODEVICE_SELECT = 1

.PHONY: demo test test-aarch64 gpu-bundle setup bench clean

## Draws the built-in figure through a running daemon: pictures, vertices and answers in out/. Needs nothing but cargo.
demo:
	$(CARGO) build --release --locked --package rigd --package contact_sheet
	target=$$($(CARGO) metadata --format-version 1 --no-deps | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p'); \
	sh scripts/demo.sh "$$target/release/rigd" "$$target/release/contact_sheet" out

## Everything that has to hold before a change is taken. What draws is tested twice: rigd's own renderer, then wgpu.
test: setup
	$(CARGO) fmt --all --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	$(CARGO) run --locked -- doctor
	$(CARGO) clippy --locked --lib --no-default-features -- -D warnings
	sh scripts/test.sh $(CARGO)
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --no-deps --document-private-items

## The accepted pictures and vertices, by a program for AArch64 under emulation. Takes long to build.
test-aarch64:
	sh scripts/test_aarch64.sh $(CARGO)

## A folder that tells, on another x86-64 Linux machine with a Vulkan driver, how rigd does on its GPU: copy it there and run ./check.sh.
gpu-bundle:
	sh scripts/gpu_bundle.sh $(CARGO) out/gpu-bundle

## What the tests need beyond cargo: the tools that the README's examples use, and software drivers for the wgpu renderer.
setup:
	sh scripts/setup.sh

## Frames a second of both renderers, how fast files become rigs, and what the service costs: writes docs/benchmarks/service.md.
bench:
	$(CARGO) bench --locked --bench drawing --bench loading --bench report

clean:
	$(CARGO) clean
	rm -rf out
