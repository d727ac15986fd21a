!> One description of a state for both directions.
program test_stream
   use, intrinsic :: iso_fortran_env, only : int8, int64
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   use check, only : test, is_true, equal_text, finish
   implicit none

   type :: state_type
      integer :: whole = 0
      integer(int64) :: long = 0
      real(wp) :: number = 0.0_wp
      logical :: flag = .false.
      character(len=:), allocatable :: word
      integer, allocatable :: list(:), pairs(:, :)
      real(wp), allocatable :: row(:), table(:, :), block(:, :, :), nothing(:)
      logical, allocatable :: switch(:)
      real(wp) :: arrow(3) = 0.0_wp
      integer :: corner(2) = 0
   end type state_type

   call what_was_written_is_read()
   call bytes_that_do_not_fit_change_nothing()
   call bytes_that_lie_about_their_shape_are_not_believed()
   call finish()

contains

   subroutine keep(self, stream)
      type(state_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%whole)
      call stream%pass(self%long)
      call stream%pass(self%number)
      call stream%pass(self%flag)
      call stream%pass(self%word)
      call stream%pass(self%list)
      call stream%pass(self%pairs)
      call stream%pass(self%row)
      call stream%pass(self%table)
      call stream%pass(self%block)
      call stream%pass(self%nothing)
      call stream%pass(self%switch)
      call stream%pass_within(self%arrow)
      call stream%pass_within(self%corner)
   end subroutine keep

   subroutine make(self)
      type(state_type), intent(out) :: self

      self%whole = -7
      self%long = 2_int64**40 + 1
      self%number = 1.0_wp/3.0_wp
      self%flag = .true.
      self%word = 'stick'
      self%list = [3, 1, 2]
      self%pairs = reshape([1, 2, 3, 4, 5, 6], [2, 3])
      self%row = [real(wp) ::]
      self%table = reshape([0.1_wp, -0.0_wp, huge(1.0_wp), tiny(1.0_wp)], [2, 2])
      allocate (self%block(1, 2, 3), source=0.7_wp)
      self%switch = [.true., .false., .true.]
      self%arrow = [1.0_wp, 2.0_wp, 3.0_wp]
      self%corner = [8, 9]
   end subroutine make

   subroutine what_was_written_is_read()
      type(state_type) :: before, after
      type(stream_type) :: stream

      call test('what was written is read, to the last bit, allocated or not')
      call make(before)
      call keep(before, stream)
      stream%reading = .true.
      allocate (after%nothing(5), after%list(9))
      call keep(after, stream)
      call is_true('all of it, and nothing behind', stream%ended() .and. .not. stream%broken)
      call is_true('scalars', after%whole == -7 .and. after%long == before%long .and. after%flag &
         & .and. after%number == before%number)
      call equal_text('text', after%word, 'stick')
      call is_true('not allocated', .not. allocated(after%nothing))
      call is_true('empty', allocated(after%row) .and. size(after%row) == 0)
      call is_true('lists', all(after%list == before%list) .and. all(after%pairs == before%pairs) &
         & .and. all(after%switch .eqv. before%switch))
      call is_true('bits', all(transfer(after%table, [0_int64]) == transfer(before%table, &
         & [0_int64])) .and. all(after%block == before%block))
      call is_true('shapes', all(shape(after%block) == [1, 2, 3]))
      call is_true('in place', all(after%arrow == before%arrow) .and. all(after%corner == [8, 9]))
   end subroutine what_was_written_is_read

   subroutine bytes_that_do_not_fit_change_nothing()
      type(state_type) :: state
      type(stream_type) :: stream
      real(wp) :: number
      integer :: whole

      call test('another kind, or too few bytes, break the stream and change nothing')
      call make(state)
      call stream%pass(state%number)
      stream%reading = .true.
      whole = 5
      call stream%pass(whole)
      call is_true('another kind', stream%broken .and. whole == 5)
      stream = stream_type()
      call stream%pass(state%table)
      stream%reading = .true.
      stream%n = stream%n - 1
      call stream%pass(state%table)
      call is_true('too few bytes', stream%broken)
      number = 2.0_wp
      call stream%pass(number)
      call is_true('what follows is left alone', number == 2.0_wp)
   end subroutine bytes_that_do_not_fit_change_nothing

   subroutine bytes_that_lie_about_their_shape_are_not_believed()
      type(state_type) :: state
      type(stream_type) :: stream

      call test('a shape larger than the bytes is not allocated')
      call make(state)
      call stream%pass(state%table)
      stream%reading = .true.
      stream%bytes(5:12) = [0_int8, 0_int8, 0_int8, 0_int8, 0_int8, 1_int8, 0_int8, 0_int8]
      call stream%pass(state%table)
      call is_true('refused', stream%broken .and. all(shape(state%table) == [2, 2]))
   end subroutine bytes_that_lie_about_their_shape_are_not_believed
end program test_stream
