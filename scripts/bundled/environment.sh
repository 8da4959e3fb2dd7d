# Makes up for what a machine with nothing but a GPU driver may lack. Sourced by the programs' starters, which
# set here.

# The file of this name that the machine's dynamic linker would take, or nothing.
machine_library() {
    for folder in $(echo "${machine_path}" | tr ':' ' '); do
        if [ -e "$folder/$1" ]; then
            echo "$folder/$1"
            return
        fi
    done
    for ldconfig in /sbin/ldconfig /usr/sbin/ldconfig; do
        if [ -x $ldconfig ]; then
            $ldconfig -p | sed -n "s|^[[:space:]]*$1 (.*x86-64.*=> ||p" | head -n 1
            return
        fi
    done
}

any_exists() {
    for file; do
        if [ -e "$file" ]; then return 0; fi
    done
    return 1
}

machine_path=${LD_LIBRARY_PATH:-}
for folder in /lib/x86_64-linux-gnu /usr/lib/x86_64-linux-gnu /lib64 /usr/lib64 /lib /usr/lib; do
    # Where the 64-bit libraries are depends on the distribution.
    if [ -e $folder/libc.so.6 ] && [ "$(head -c 5 $folder/libc.so.6 | tail -c 1)" = "$(printf '\2')" ]; then
        machine_path=$machine_path:$folder
    fi
done

# A driver may need newer ones of these than are here: only what the machine lacks is taken from here.
for folder in "$here"/fallback/*; do
    name=${folder##*/}
    found=$(machine_library "$name")
    if [ -n "$found" ] && [ "$name" = libstdc++.so.6 ] && ! grep -q "@cxx@" "$found"; then found=; fi
    if [ -z "$found" ]; then LD_LIBRARY_PATH=${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$folder; fi
done
if [ -n "${LD_LIBRARY_PATH:-}" ]; then export LD_LIBRARY_PATH; fi

# NVIDIA's driver mounted into a container comes without the files that name it to the loaders.
if [ -n "$(machine_library libEGL_nvidia.so.0)" ] && [ -z "${__EGL_VENDOR_LIBRARY_FILENAMES:-}" ] &&
    [ -z "${__EGL_VENDOR_LIBRARY_DIRS:-}" ] &&
    ! any_exists /etc/glvnd/egl_vendor.d/*nvidia*.json /usr/share/glvnd/egl_vendor.d/*nvidia*.json; then
    # The loader takes this list instead of its own.
    __EGL_VENDOR_LIBRARY_FILENAMES=$here/drivers/egl_nvidia.json
    for file in /etc/glvnd/egl_vendor.d/*.json /usr/share/glvnd/egl_vendor.d/*.json; do
        if [ -e "$file" ]; then __EGL_VENDOR_LIBRARY_FILENAMES=$__EGL_VENDOR_LIBRARY_FILENAMES:$file; fi
    done
    export __EGL_VENDOR_LIBRARY_FILENAMES
fi
if [ -z "${VK_DRIVER_FILES:-}" ] && [ -z "${VK_ICD_FILENAMES:-}" ] &&
    ! any_exists /etc/vulkan/icd.d/*nvidia*.json /usr/share/vulkan/icd.d/*nvidia*.json \
        /usr/local/share/vulkan/icd.d/*nvidia*.json; then
    for name in GLX EGL; do
        if [ -n "$(machine_library lib${name}_nvidia.so.0)" ]; then
            VK_ADD_DRIVER_FILES=$here/drivers/vulkan_nvidia_$name.json${VK_ADD_DRIVER_FILES:+:$VK_ADD_DRIVER_FILES}
            export VK_ADD_DRIVER_FILES
            break
        fi
    done
fi

if [ -e "$here/layers/VkLayer_khronos_validation.json" ]; then
    VK_ADD_LAYER_PATH=$here/layers${VK_ADD_LAYER_PATH:+:$VK_ADD_LAYER_PATH}
    export VK_ADD_LAYER_PATH
fi
