//! Buffers that MPI reads from or writes to while the ranks compute.

use mpi::request::WaitGuard;

/// Buffers, and the requests of MPI that use them. The buffers stay in their place on the heap until every request has
/// ended, whether the value is finished or dropped, and even if it is moved. If it is leaked, the buffers are leaked
/// too.
pub(super) struct Travelling<B, T: ?Sized + 'static> {
    // Fields are dropped in this order: the requests end first.
    requests: Vec<WaitGuard<'static, T>>,
    buffers: Box<B>,
}

impl<B: 'static, T: ?Sized> Travelling<B, T> {
    /// Begins requests on buffers.
    pub(super) fn begin(
        buffers: B,
        begin: impl FnOnce(&'static mut B) -> Vec<WaitGuard<'static, T>>,
    ) -> Self {
        let mut buffers = Box::new(buffers);
        let lent: *mut B = &mut *buffers;
        #[expect(unsafe_code, reason = "requests outlive the function that begins them")]
        // SAFETY: the box keeps the buffers in their place. They are neither read nor changed while a request uses
        // them, and they are freed or given back only when all requests have ended: `finish` and drop ensure this, in
        // this order.
        let requests = begin(unsafe { &mut *lent });
        Self { requests, buffers }
    }

    /// Waits until all requests have ended, and returns the buffers.
    pub(super) fn finish(self) -> B {
        let Self { requests, buffers } = self;
        drop(requests);
        *buffers
    }
}
