#!/bin/sh
# test_wgpu.sh CARGO: the tests of what is drawn, skinned and picked once more, by wgpu on Mesa's software Vulkan driver.
set -eu

if ! sh scripts/has_driver.sh; then
    echo "WARNING: there is no software Vulkan driver: the wgpu renderer was NOT tested" >&2
    exit 0
fi
export RIGD_TEST_ADAPTER=llvmpipe
exec "$1" test --locked --test pictures --test textures --test skeletons --test skinning --test turning --test picking \
    --test requests --test real_files --test steady --test shutdown
