!> `job.rst`: the state of a run after an accepted increment, from which `--resume` goes on.
!>
!> Six lines (what it is, the version of Lopin, the fingerprints of the deck and of the state, the
!> number of bytes, the path of the deck), then the bytes of lopin_checkpoint. It is replaced whole,
!> so that there is always one good state whenever the process dies; a finished run has none. Once a
!> second it is also on the disk before it takes its name, after the result files whose lengths it
!> holds, which a power failure asks for and which takes milliseconds.
module lopin_checkpoint_file
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_checksum, only : checksum_type
   use lopin_stream, only : stream_type
   use lopin_text, only : to_text
   use lopin_version, only : version
   use lopin_checkpoint_store, only : checkpoint_store_type
   use, intrinsic :: iso_c_binding, only : c_int, c_char, c_null_char
   use lopin_atomic_file, only : write_atomically, remove_file, file_exists, read_text
   use lopin_checked_file, only : sync_folder, cannot_write
   use lopin_folder_lock, only : folder_lock_type
   implicit none
   private
   public :: checkpoint_file_type, new_checkpoint_file

   !> The number tells layouts of one version apart.
   character(len=*), parameter :: mark = 'Lopin checkpoint 16', newline = achar(10)
   integer, parameter :: nline = 6
   real(wp), parameter :: between = 1.0_wp      !! waits for the disk, at least [s]
   real(wp), parameter :: share = 0.05_wp       !! of the time that goes by in waiting, at most

   type, extends(checkpoint_store_type) :: checkpoint_file_type
      character(len=:), allocatable, private :: path
      character(len=16), private :: deck = ''      !! fingerprint of the deck
      character(len=:), allocatable, private :: deck_path   !! from the root; '': in memory only
      integer(int64), private :: next = 0          !! clock from when the disk is waited for
      type(folder_lock_type) :: lock
   contains
      procedure :: save
      procedure :: forget
      procedure :: settle
   end type checkpoint_file_type

   interface
      integer(c_int) function lopin_full_path(path, full, n) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: full(*)
         integer(c_int), value :: n
      end function lopin_full_path
   end interface

contains

   !> With `resume`, `found` is what the file holds; without a file it stays unallocated. A file
   !> that is not the state of this deck, whole and of this version is refused. Without `resume`, a
   !> file of a deck in another place is refused unless it may be overwritten.
   subroutine new_checkpoint_file(self, path, deck, deck_path, resume, overwrite, error)
      type(checkpoint_file_type), intent(out) :: self
      character(len=*), intent(in) :: path
      type(checksum_type), intent(in) :: deck    !! of all that the deck says
      character(len=*), intent(in) :: deck_path  !! of the deck, as its reader gave it
      logical, intent(in) :: resume, overwrite
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text, other

      self%path = path
      self%deck_path = full_path(deck_path)
      self%deck = deck%text()
      call self%lock%take(path(:index(path, '.', back=.true.))//'lock', error)
      if (allocated(error)) return
      if (.not. file_exists(path)) return
      call read_text(path, text)
      if (resume) then
         call take(self, text, error)
      else if (index(text, mark(:16)) /= 1) then
         call raise(error, error_code%resource, 'E0603', "'"//path//"' exists and was not "// &
            & 'written by Lopin', help='choose another folder with -o, or move the file away')
      else
         self%kept = 'the last increment of the earlier run'
         other = line_of(text, nline)
         if (.not. overwrite .and. len(other) > 0 .and. len(self%deck_path) > 0 .and. &
            & other /= self%deck_path) call raise(error, error_code%resource, 'E0601', &
            & "'"//path(:index(path, '/', back=.true.))// &
            & "' holds the unfinished run of another deck, '"//other//"'", &
            & help='give another folder with -o, go on with that deck and --resume, or replace '// &
            & 'its results with --overwrite')
      end if
   end subroutine new_checkpoint_file

   !> From the root; empty for what is no file.
   function full_path(path) result(full)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: full
      character(len=4096) :: found
      integer(c_int) :: n

      n = lopin_full_path(path//c_null_char, found, int(len(found), c_int))
      full = found(:n)
      ! The header ends its lines so.
      if (index(full, newline) > 0) full = ''
   end function full_path

   !> A line of the header; empty where there is none, and in headers of earlier layouts.
   pure function line_of(text, number) result(line)
      character(len=*), intent(in) :: text
      integer, intent(in) :: number
      character(len=:), allocatable :: line
      integer :: at, i, n

      line = ''
      if (index(text, mark//newline) /= 1) return
      at = 1
      do i = 1, number
         n = index(text(at:), newline)
         if (n == 0) return
         line = text(at:at + n - 2)
         at = at + n
      end do
   end function line_of

   !> The state out of the text of a file.
   subroutine take(self, text, error)
      type(checkpoint_file_type), intent(inout) :: self
      character(len=*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      character(len=40) :: line(nline)
      integer :: at, i, stop_
      type(checksum_type) :: sum
      integer(int64) :: n
      integer :: status

      line = ''
      at = 1
      do i = 1, nline
         stop_ = index(text(at:), newline)
         if (stop_ == 0) exit
         line(i) = text(at:at + stop_ - 2)
         at = at + stop_
      end do
      if (line(1)(:16) /= mark(:16)) then
         call refuse(self%path, 'it is not a checkpoint of Lopin', error)
      else if (line(2) == version .and. line(1) /= mark) then
         call refuse(self%path, 'it was written by another state of Lopin '//version, error)
      else if (line(2) /= version) then
         call refuse(self%path, 'it was written by Lopin '//trim(line(2))//', and this is '// &
            & version, error)
      else if (line(3) /= self%deck) then
         call refuse(self%path, 'it is of another deck, or the deck, a file it includes, its '// &
            & 'STL files or --solver have changed since', error)
      end if
      if (allocated(error)) return
      read (line(5), *, iostat=status) n
      if (status /= 0) n = -1
      if (n /= len(text, kind=int64) - at + 1) then
         call refuse(self%path, 'it is cut short: '//to_text(len(text) - at + 1)//' bytes of '// &
            & trim(line(5)), error)
         return
      end if
      allocate (self%found)
      self%found%n = n
      allocate (self%found%bytes(n))
      self%found%bytes = transfer(text(at:), self%found%bytes)
      call sum%add_bytes(self%found%bytes)
      if (sum%text() == line(4)) return
      deallocate (self%found)
      call refuse(self%path, 'it is damaged: its bytes are not those of its fingerprint', error)
   end subroutine take

   subroutine refuse(path, reason, error)
      character(len=*), intent(in) :: path, reason
      type(error_type), allocatable, intent(out) :: error
      call raise(error, error_code%resource, 'E0604', "cannot go on from '"//path//"': "//reason, &
         & help='run the deck without --resume, or resume the deck that wrote it')
   end subroutine refuse

   subroutine save(self, stream, error)
      class(checkpoint_file_type), intent(inout) :: self
      type(stream_type), intent(in) :: stream
      type(error_type), allocatable, intent(out) :: error
      type(checksum_type) :: sum
      integer(int64) :: now, ready, rate
      logical :: wait

      call system_clock(now, rate)
      wait = now >= self%next
      if (wait) call self%settle(error)
      if (allocated(error)) return
      call sum%add_bytes(stream%bytes(:stream%n))
      call write_atomically(self%path, mark//newline//version//newline//self%deck//newline// &
         & sum%text()//newline//to_text(stream%n)//newline//self%deck_path//newline, error, &
         & stream%bytes(:stream%n), lasting=wait)
      if (.not. wait) return
      call system_clock(ready)
      self%next = ready + max(int(between*real(rate, wp), int64), &
         & int(real(ready - now, wp)/share, int64))
   end subroutine save

   !> All that the run has written is on the disk.
   subroutine settle(self, error)
      class(checkpoint_file_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status

      if (self%lock%file < 0) return
      status = sync_folder(self%lock%file)
      if (status /= 0) call cannot_write(self%path(:index(self%path, '/', back=.true.)), status, &
         & error)
   end subroutine settle

   subroutine forget(self)
      class(checkpoint_file_type), intent(inout) :: self

      if (allocated(self%kept)) deallocate (self%kept)
      call remove_file(self%path)
      ! What a killed run was writing.
      call remove_file(self%path//'.part')
   end subroutine forget
end module lopin_checkpoint_file
