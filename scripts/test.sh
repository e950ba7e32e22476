#!/bin/sh
# test.sh CARGO: all tests, and those of what is drawn once more by wgpu on each software driver that is installed.
set -eu

cargo=$1
swiftshader=$(sh scripts/driver.sh swiftshader) || swiftshader=""

# Without these drivers the tests that need them pass; with them, one that finds none has failed.
if sh scripts/driver.sh lavapipe >/dev/null && sh scripts/driver.sh gl >/dev/null; then
    export RIGD_REQUIRE_ADAPTER=1
fi
"$cargo" test --locked

if sh scripts/driver.sh lavapipe >/dev/null; then
    RIGD_TEST_ADAPTER=llvmpipe "$cargo" test --locked --test pictures --test textures --test skeletons --test skinning --test turning \
        --test picking --test requests --test real_files --test steady --test shutdown
else
    echo "WARNING: there is no software Vulkan driver: the wgpu renderer was NOT tested" >&2
fi
# Alone, so that no other driver is taken for it. Older loaders know the second name.
if [ -n "$swiftshader" ]; then
    RIGD_TEST_ADAPTER=swiftshader VK_DRIVER_FILES=$swiftshader VK_ICD_FILENAMES=$swiftshader "$cargo" test --locked --test parity \
        --test materials --test extensions --test obj --test device
fi
