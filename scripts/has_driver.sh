#!/bin/sh
# Succeeds where Mesa's software Vulkan driver is installed: the loader reads its drivers' manifests from these folders.
for manifest in /usr/share/vulkan/icd.d/*lvp*.json /etc/vulkan/icd.d/*lvp*.json "${VK_DRIVER_FILES:-}" "${VK_ICD_FILENAMES:-}"; do
    [ -f "$manifest" ] && exit 0
done
exit 1
