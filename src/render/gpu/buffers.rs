//! Buffers that live as long as the device: some grow and stay, some go around between the device and the reader.

use super::device::Device;
use wgpu::{Buffer, BufferUsages};

/// A buffer that is as large as the largest thing put into it so far.
pub(super) struct Growing {
    buffer: Buffer,
    label: &'static str,
    usage: BufferUsages,
}

impl Growing {
    /// Room for a handful of small rigs, so that the first pictures need no second allocation.
    const FIRST_BYTES: u64 = 1 << 18;

    pub(super) fn new(device: &Device, label: &'static str, usage: BufferUsages) -> Self {
        let usage = usage | BufferUsages::COPY_DST;
        Self {
            buffer: create(device, label, usage, Self::FIRST_BYTES),
            label,
            usage,
        }
    }

    /// Whether the buffer was replaced by a larger one, and with it every bind group that names it.
    pub(super) fn reserve(&mut self, device: &Device, bytes: u64) -> bool {
        let grows = bytes > self.buffer.size();
        if grows {
            let roomy = bytes.next_power_of_two().min(device.buffer_bytes);
            self.buffer = create(device, self.label, self.usage, roomy.max(bytes));
        }
        grows
    }

    /// Puts `contents` at the start. Returns whether the buffer was replaced, as [`Growing::reserve`] does.
    pub(super) fn write<T: bytemuck::NoUninit>(&mut self, device: &Device, contents: &[T]) -> bool {
        let bytes: &[u8] = bytemuck::cast_slice(contents);
        let grew = self.reserve(device, bytes.len() as u64);
        device.queue.write_buffer(&self.buffer, 0, bytes);
        grew
    }

    pub(super) fn buffer(&self) -> &Buffer {
        &self.buffer
    }
}

/// Buffers that the reader maps, lent to one submission each.
#[derive(Default)]
pub(super) struct Readbacks {
    free: Vec<Buffer>,
}

impl Readbacks {
    /// Twice as many as are in flight at most.
    const KEPT: usize = 4;
    /// What they may take together; a single one may take more.
    const MOST_BYTES: u64 = 256 << 20;
    /// Room for a submission of small pictures, so that one buffer is as good as another.
    const FIRST_BYTES: u64 = 1 << 20;

    pub(super) fn lend(&mut self, device: &Device, bytes: u64) -> Buffer {
        let fits = |buffer: &&(usize, &Buffer)| buffer.1.size() >= bytes;
        let smallest = self
            .free
            .iter()
            .enumerate()
            .filter(|b| fits(&b))
            .min_by_key(|(_, buffer)| buffer.size());
        match smallest.map(|(index, _)| index) {
            Some(index) => self.free.remove(index),
            None => {
                let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
                let roomy = bytes.next_power_of_two().min(device.buffer_bytes);
                let roomy = roomy.max(bytes).max(Self::FIRST_BYTES);
                create(device, "readback.mapped", usage, roomy)
            }
        }
    }

    /// Takes an unmapped buffer back. Of too many the smallest goes, as the others can stand in for it; of too large ones the one that was
    /// not wanted for the longest time.
    pub(super) fn give_back(&mut self, buffer: Buffer) {
        self.free.push(buffer);
        if self.free.len() > Self::KEPT {
            let sizes = self.free.iter().map(Buffer::size).enumerate();
            if let Some((smallest, _)) = sizes.min_by_key(|(_, size)| *size) {
                self.free.remove(smallest);
            }
        }
        while self.free.len() > 1 && self.bytes() > Self::MOST_BYTES {
            self.free.remove(0);
        }
    }

    pub(super) fn bytes(&self) -> u64 {
        self.free.iter().map(Buffer::size).sum()
    }
}

pub(super) fn create(device: &Device, label: &str, usage: BufferUsages, bytes: u64) -> Buffer {
    let size = bytes
        .next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
        .max(wgpu::COPY_BUFFER_ALIGNMENT);
    device.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// A buffer that holds `contents` and nothing else, ever.
pub(super) fn filled<T: bytemuck::NoUninit>(
    device: &Device,
    label: &str,
    usage: BufferUsages,
    contents: &[T],
) -> Buffer {
    use wgpu::util::DeviceExt;
    let contents = bytemuck::cast_slice(contents);
    device
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage,
        })
}
