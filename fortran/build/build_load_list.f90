!> The lists of loads in force, grown from step to step.
module lopin_build_load_list
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, point_load_type, face_load_type, body_load_type
   use lopin_build_amplitudes, only : hold_value
   implicit none
   private
   public :: loads_type, family_of, new_loads, hold_loads, drop_dloads, drop_dsloads, drop_replaced
   public :: add_point, add_face, add_body

   !> Families of loads on faces: a new one replaces an old one of its own family only.
   type :: families
      integer :: dload = 1, dsload = 2, traction = 3
   end type families
   type(families), parameter :: family_of = families()

   !> Loads in force, with the step in which each was given and the latest step of each place.
   type :: loads_type
      integer :: npoint = 0, nface = 0, nbody = 0
      type(point_load_type), allocatable :: point(:)
      type(face_load_type), allocatable :: face(:)
      type(body_load_type), allocatable :: body(:)
      integer, allocatable :: point_born(:), face_born(:), body_born(:)
      integer, allocatable :: face_family(:), body_family(:)
      integer, allocatable :: point_latest(:, :)     !! (6, nnode)
      integer, allocatable :: face_latest(:, :, :)   !! (6, 3, nelement)
      integer, allocatable :: body_latest(:, :)      !! (4, nelement): x, y, z, gravity
   end type loads_type

contains

   subroutine new_loads(self, nnode, nelement)
      type(loads_type), intent(out) :: self
      integer, intent(in) :: nnode, nelement

      allocate (self%point(16), self%face(16), self%body(16))
      allocate (self%point_born(16), self%face_born(16), self%body_born(16), source=0)
      allocate (self%face_family(16), self%body_family(16), source=0)
      allocate (self%point_latest(6, nnode), self%face_latest(6, 3, nelement), &
         & self%body_latest(4, nelement), source=0)
   end subroutine new_loads

   !> What goes on into the next step keeps the value it had at the end.
   subroutine hold_loads(self, model, period)
      type(loads_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: period
      real(wp) :: factor
      integer :: i

      call hold_value(model, period, self%point(:self%npoint)%amplitude, &
         & self%point(:self%npoint)%value)
      do i = 1, self%nface
         factor = 1.0_wp
         call hold_value(model, period, self%face(i)%amplitude, factor)
         self%face(i)%pressure = factor*self%face(i)%pressure
         self%face(i)%traction = factor*self%face(i)%traction
      end do
      do i = 1, self%nbody
         factor = 1.0_wp
         call hold_value(model, period, self%body(i)%amplitude, factor)
         self%body(i)%force = factor*self%body(i)%force
      end do
   end subroutine hold_loads

   subroutine drop_dloads(self)
      type(loads_type), intent(inout) :: self

      call keep_faces(self, self%face_family(:self%nface) /= family_of%dload)
      self%nbody = 0
   end subroutine drop_dloads

   subroutine drop_dsloads(self)
      type(loads_type), intent(inout) :: self
      call keep_faces(self, self%face_family(:self%nface) == family_of%dload)
   end subroutine drop_dsloads

   subroutine keep_faces(self, keep)
      type(loads_type), intent(inout) :: self
      logical, intent(in) :: keep(:)
      integer :: i, n

      n = 0
      do i = 1, self%nface
         if (.not. keep(i)) cycle
         n = n + 1
         self%face(n) = self%face(i)
         self%face_born(n) = self%face_born(i)
         self%face_family(n) = self%face_family(i)
      end do
      self%nface = n
   end subroutine keep_faces

   !> Remove the loads for which a later step gave a new value.
   subroutine drop_replaced(self)
      type(loads_type), intent(inout) :: self
      logical, allocatable :: keep(:)
      integer :: i, n

      n = 0
      do i = 1, self%npoint
         if (self%point_born(i) < self%point_latest(self%point(i)%dof, self%point(i)%node)) cycle
         n = n + 1
         self%point(n) = self%point(i)
         self%point_born(n) = self%point_born(i)
      end do
      self%npoint = n
      allocate (keep(self%nface))
      do i = 1, self%nface
         keep(i) = self%face_born(i) == self%face_latest(self%face(i)%face, self%face_family(i), &
            & self%face(i)%element)
      end do
      call keep_faces(self, keep)
      n = 0
      do i = 1, self%nbody
         if (self%body_born(i) < self%body_latest(self%body_family(i), self%body(i)%element)) cycle
         n = n + 1
         self%body(n) = self%body(i)
         self%body_born(n) = self%body_born(i)
         self%body_family(n) = self%body_family(i)
      end do
      self%nbody = n
   end subroutine drop_replaced

   pure subroutine add_point(self, load, step)
      type(loads_type), intent(inout) :: self
      type(point_load_type), intent(in) :: load
      integer, intent(in) :: step
      type(point_load_type), allocatable :: grown(:)

      if (self%npoint == size(self%point)) then
         allocate (grown(2*self%npoint))
         grown(:self%npoint) = self%point
         call move_alloc(grown, self%point)
         self%point_born = [self%point_born, self%point_born]
      end if
      self%npoint = self%npoint + 1
      self%point(self%npoint) = load
      self%point_born(self%npoint) = step
   end subroutine add_point

   pure subroutine add_face(self, load, family, step)
      type(loads_type), intent(inout) :: self
      type(face_load_type), intent(in) :: load
      integer, intent(in) :: family, step
      type(face_load_type), allocatable :: grown(:)

      if (self%nface == size(self%face)) then
         allocate (grown(2*self%nface))
         grown(:self%nface) = self%face
         call move_alloc(grown, self%face)
         self%face_born = [self%face_born, self%face_born]
         self%face_family = [self%face_family, self%face_family]
      end if
      self%nface = self%nface + 1
      self%face(self%nface) = load
      self%face(self%nface)%family = family
      self%face_born(self%nface) = step
      self%face_family(self%nface) = family
      self%face_latest(load%face, family, load%element) = step
   end subroutine add_face

   pure subroutine add_body(self, load, family, step)
      type(loads_type), intent(inout) :: self
      type(body_load_type), intent(in) :: load
      integer, intent(in) :: family, step
      type(body_load_type), allocatable :: grown(:)

      if (self%nbody == size(self%body)) then
         allocate (grown(2*self%nbody))
         grown(:self%nbody) = self%body
         call move_alloc(grown, self%body)
         self%body_born = [self%body_born, self%body_born]
         self%body_family = [self%body_family, self%body_family]
      end if
      self%nbody = self%nbody + 1
      self%body(self%nbody) = load
      self%body(self%nbody)%family = family
      self%body_born(self%nbody) = step
      self%body_family(self%nbody) = family
      self%body_latest(family, load%element) = step
   end subroutine add_body
end module lopin_build_load_list
