!> Pressures under NLGEOM as functions of time; they follow their faces.
!>
!> Time rules are those of all loads (see lopin_loading): without an amplitude a pressure goes
!> linearly from its value at the end of the last step to its new one, a pressure that is no longer
!> in force to zero; with an amplitude it is value times amplitude, at once where it replaces one
!> without.
module lopin_follower_loading
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, step_type, face_load_type, amplitude_value
   use lopin_local_matrix, only : local_matrix_type
   use lopin_state, only : pressures_type
   implicit none
   private
   public :: follower_type, new_followers, set_followers, leave_followers, resume_followers
   public :: follow_steps

   !> One entry for each face and load.
   type :: follower_type
      integer, allocatable :: element(:), face(:)
      integer, allocatable :: family(:)          !! of its card
      real(wp), allocatable :: from(:), to(:)    !! without amplitude [stress]
      real(wp), allocatable :: varying(:)        !! times amplitude [stress]
      integer, allocatable :: amplitude(:)       !! 0: none
      real(wp), allocatable :: steady(:)         !! part without amplitude now [stress]
      real(wp), allocatable :: pressure(:)       !! now [stress]
      real(wp) :: start = 0.0_wp, period = 1.0_wp
      logical :: ramp = .true.
      ! at the trial displacements
      real(wp), allocatable :: force(:)               !! (ndof) [force]
      type(local_matrix_type), allocatable :: local(:)   !! tangents, one for each entry
   end type follower_type

contains

   !> What the pressures are now, for the step that starts with them.
   subroutine leave_followers(self, now)
      type(follower_type), intent(in) :: self
      type(pressures_type), intent(inout) :: now

      if (.not. allocated(self%element)) return
      now%element = self%element
      now%face = self%face
      now%family = self%family
      now%steady = self%steady
      now%pressure = self%pressure
   end subroutine leave_followers

   !> Pressures that a step started with.
   subroutine resume_followers(self, before, ndof)
      type(follower_type), intent(inout) :: self
      type(pressures_type), intent(in) :: before
      integer, intent(in) :: ndof

      if (.not. allocated(before%element)) return
      call clear(self, ndof)
      self%element = before%element
      self%face = before%face
      self%family = before%family
      self%steady = before%steady
      self%pressure = before%pressure
   end subroutine resume_followers

   !> Pressures of a step; before the call `self` are those at the end of the last step.
   subroutine new_followers(self, step, start, ndof)
      type(follower_type), intent(inout) :: self
      type(step_type), intent(in) :: step
      real(wp), intent(in) :: start              !! total time
      integer, intent(in) :: ndof
      type(follower_type) :: old
      integer :: i, k

      if (.not. allocated(self%element)) call clear(self, ndof)
      old = self
      call clear(self, ndof)
      self%start = start
      self%period = step%period
      self%ramp = step%ramp
      do i = 1, size(step%face_load)
         associate (load => step%face_load(i))
            if (.not. abs(load%pressure) > 0.0_wp .and. load%amplitude == 0) cycle
            if (any(abs(load%traction) > 0.0_wp)) cycle
            call add(self, load)
         end associate
      end do
      do k = 1, size(old%element)
         call go_on(self, old, k)
      end do
   end subroutine new_followers

   !> Pressures at the end of the first steps of a model: where a part of a run begins behind them.
   subroutine follow_steps(self, model, nstep, ndof)
      type(follower_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: nstep, ndof
      integer :: s

      do s = 1, nstep
         call new_followers(self, model%step(s), sum(model%step(:s - 1)%period), ndof)
         call set_followers(self, model, model%step(s)%period)
      end do
   end subroutine follow_steps

   subroutine clear(self, ndof)
      type(follower_type), intent(inout) :: self
      integer, intent(in) :: ndof

      self%element = [integer ::]
      self%face = self%element
      self%family = self%element
      self%amplitude = self%element
      self%from = [real(wp) ::]
      self%to = self%from
      self%varying = self%from
      self%steady = self%from
      self%pressure = self%from
      if (allocated(self%force)) deallocate (self%force)
      allocate (self%force(ndof), source=0.0_wp)
      if (allocated(self%local)) deallocate (self%local)
      allocate (self%local(0))
   end subroutine clear

   subroutine add(self, load)
      type(follower_type), intent(inout) :: self
      type(face_load_type), intent(in) :: load
      real(wp) :: steady

      steady = merge(load%pressure, 0.0_wp, load%amplitude == 0)
      self%element = [self%element, load%element]
      self%face = [self%face, load%face]
      self%family = [self%family, load%family]
      self%from = [self%from, 0.0_wp]
      self%to = [self%to, steady]
      self%varying = [self%varying, load%pressure - steady]
      self%amplitude = [self%amplitude, load%amplitude]
      self%steady = [self%steady, 0.0_wp]
      self%pressure = [self%pressure, 0.0_wp]
   end subroutine add

   !> What an old pressure leaves to the new step: all of it where the face no longer follows an
   !> amplitude, nothing where it is given again and follows one.
   subroutine go_on(self, old, k)
      type(follower_type), intent(inout) :: self
      type(follower_type), intent(in) :: old
      integer, intent(in) :: k
      logical :: same(size(self%element))
      real(wp) :: last
      integer :: i

      same = self%element == old%element(k) .and. self%face == old%face(k) &
         & .and. self%family == old%family(k)
      last = old%pressure(k)
      if (any(same .and. self%amplitude > 0)) last = old%steady(k)
      if (any(same) .and. all(self%amplitude > 0 .or. .not. same)) last = 0.0_wp
      if (.not. abs(last) > 0.0_wp) return
      i = findloc(same .and. self%amplitude == 0, .true., dim=1)
      if (i == 0) then
         call add(self, face_load_type(element=old%element(k), face=old%face(k), &
            & family=old%family(k)))
         i = size(self%from)
      end if
      self%from(i) = self%from(i) + last
      self%steady(i) = self%from(i)
      self%pressure(i) = self%from(i)
   end subroutine go_on

   !> Pressures at a time of the step.
   subroutine set_followers(self, model, step_time)
      type(follower_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: step_time
      real(wp) :: share, time
      integer :: k

      share = 1.0_wp
      if (self%ramp) share = min(1.0_wp, step_time/self%period)
      self%steady = self%from + share*(self%to - self%from)
      if (.not. share < 1.0_wp) self%steady = self%to
      self%pressure = self%steady
      do k = 1, size(self%element)
         if (self%amplitude(k) == 0) cycle
         time = step_time
         if (model%amplitude(self%amplitude(k))%total_time) time = time + self%start
         self%pressure(k) = self%pressure(k) + self%varying(k) &
            & *amplitude_value(model%amplitude(self%amplitude(k)), time)
      end do
   end subroutine set_followers
end module lopin_follower_loading
