#!/bin/sh
# driver.sh lavapipe|gl|swiftshader: prints the file by which that software driver is found, and fails where it is not installed.
case $1 in
# Mesa's Vulkan driver: the loader reads the drivers' manifests from these folders.
lavapipe) set -- /usr/share/vulkan/icd.d/*lvp*.json /etc/vulkan/icd.d/*lvp*.json "${VK_DRIVER_FILES:-}" "${VK_ICD_FILENAMES:-}" ;;
# Mesa's GL driver.
gl) set -- /usr/lib/*/dri/swrast_dri.so /usr/lib/dri/swrast_dri.so /usr/lib64/dri/swrast_dri.so ;;
# A second Vulkan driver, which comes with Chromium and Chrome; or the manifest that RIGD_SWIFTSHADER names.
swiftshader) set -- "${RIGD_SWIFTSHADER:-}" /usr/lib/chromium/vk_swiftshader_icd.json /opt/google/chrome/vk_swiftshader_icd.json ;;
esac
for file; do
    [ -f "$file" ] && echo "$file" && exit 0
done
exit 1
