//! Bounded reading of little-endian numbers and of Zlib data.

/// Reads bytes in order. Errors are reasons, without the file.
#[derive(Clone, Copy)]
pub struct Bytes<'a> {
    all: &'a [u8],
    /// Position of the next byte.
    at: usize,
}

impl<'a> Bytes<'a> {
    /// Starts at a position, which the file gives.
    pub fn starting_at(all: &'a [u8], at: i64) -> Result<Self, String> {
        let found = usize::try_from(at).ok().filter(|at| *at <= all.len());
        let refuse = || format!("a grid is said to be at byte {at}; expected one of {}", all.len());
        Ok(Self { all, at: found.ok_or_else(refuse)? })
    }

    /// Position of the next byte.
    pub fn position(&self) -> usize {
        self.at
    }

    /// Returns the next bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.all.get(self.at..end));
        let cut = || format!("the file ends at byte {}; expected {count} bytes from byte {}", self.all.len(), self.at);
        let taken = taken.ok_or_else(cut)?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8, String> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, String> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, String> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, String> {
        self.array().map(f64::from_le_bytes)
    }

    /// Returns bytes that follow their number.
    pub fn sized(&mut self) -> Result<&'a [u8], String> {
        let size = self.u32()?;
        self.take(size as usize)
    }

    pub fn string(&mut self) -> Result<String, String> {
        Ok(String::from_utf8_lossy(self.sized()?).into_owned())
    }
}

/// Decompresses Zlib data of `size` bytes.
pub fn inflate(packed: &[u8], size: usize) -> Result<Vec<u8>, String> {
    let data = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(packed, size);
    let data = data.map_err(|_| "Zip data is damaged; expected a whole file")?;
    if data.len() != size {
        return Err(format!("{} bytes in Zip; expected {size}", data.len()));
    }
    Ok(data)
}
