!> What evolves: a trial that is begun, accepted, rejected, and written and read.
program test_state
   use lopin_kinds, only : wp
   use lopin_stream, only : stream_type
   use lopin_friction_state, only : new_friction_history
   use lopin_state, only : state_type, begin, accept, reject, new_contact_state
   use check, only : test, is_true, finish
   implicit none

   call the_verbs()
   call what_was_written_is_read()
   call finish()

contains

   !> Two slave points of each path, three degrees of freedom, one integration point.
   subroutine make(self)
      type(state_type), intent(out) :: self

      allocate (self%motion%u(3), self%loads%steady(3), self%loads%force(3), &
         & self%loads%reaction(3), source=0.0_wp)
      allocate (self%solids%value(10, 1), source=0.0_wp)
      call new_contact_state(self%contact, 3, 2, [.true., .false.])
      call new_friction_history(self%friction, [.false., .true.])
   end subroutine make

   !> Something of every part changes.
   subroutine go_on(self, by)
      type(state_type), intent(inout) :: self
      real(wp), intent(in) :: by

      self%motion%last = self%motion%u + by
      self%motion%u = self%motion%u + by
      self%solids%value = self%solids%value + by
      self%contact%traction = self%contact%traction - by
      self%contact%closed = .not. self%contact%closed
      self%contact%held = [.true.]
      self%friction%path = self%friction%path + by
      self%friction%force = [by, 2.0_wp*by]
      self%loads%work = self%loads%work + by
      self%clock%time = self%clock%time + by
      self%clock%number = self%clock%number + 1
   end subroutine go_on

   subroutine the_verbs()
      type(state_type) :: accepted, trial

      call test('begin, accept, reject')
      call make(accepted)
      call begin(trial, accepted)
      call is_true('a trial begins as what was accepted', same(trial, accepted))
      call go_on(trial, 0.25_wp)
      call is_true('and goes on without it', .not. same(trial, accepted))
      call reject(trial, accepted)
      call is_true('a rejected one leaves nothing', same(trial, accepted))
      call is_true('nor what it was first to hold', .not. allocated(trial%contact%held))
      call go_on(trial, 0.125_wp)
      call accept(accepted, trial)
      call is_true('an accepted one is the state', same(trial, accepted))
      call is_true('that others begin from', accepted%clock%number == 1)
   end subroutine the_verbs

   subroutine what_was_written_is_read()
      type(state_type) :: state, other
      type(stream_type) :: to, from

      call test('pass')
      call make(state)
      call go_on(state, 1.0_wp/3.0_wp)
      call state%pass(to)
      from%reading = .true.
      from%n = to%n
      from%bytes = to%bytes
      call make(other)
      call other%pass(from)
      call is_true('all of it', from%ended() .and. .not. from%broken)
      call is_true('the same bits', same(state, other))
   end subroutine what_was_written_is_read

   !> By the bytes that either writes.
   logical function same(a, b)
      type(state_type), intent(in) :: a, b
      type(state_type) :: copy
      type(stream_type) :: one, two

      copy = a
      call copy%pass(one)
      copy = b
      call copy%pass(two)
      same = one%n == two%n
      if (same) same = all(one%bytes(:one%n) == two%bytes(:two%n))
   end function same
end program test_state
