!> A mesh: nodes, elements, named sets. Arrays are (component, item); labels are the user's numbers.
module lopin_mesh
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, location_type, nowhere
   implicit none
   private
   public :: mesh_type, set_type, max_nodes_per_element, find_label, find_set, place_of_element
   public :: place_by_element

   integer, parameter :: max_nodes_per_element = 20

   !> A named list of indices (not labels), in the user's order, without repetition.
   type :: set_type
      character(len=:), allocatable :: name   !! upper case unless it was quoted
      integer, allocatable :: member(:)
   end type set_type

   !> Indices run 1..nnode and 1..nelement in the order of the deck.
   type :: mesh_type
      integer :: ndim = 0                       !! 2 or 3
      integer :: nnode = 0
      integer :: nelement = 0
      real(wp), allocatable :: x(:, :)   !! (ndim, nnode) coordinates [length]; (r, z) if
                                         !! axisymmetric
      integer, allocatable :: node_label(:)     !! (nnode)
      integer, allocatable :: conn(:, :)   !! (20, nelement) node indices, zeros behind the last
      integer, allocatable :: etype(:)   !! (nelement) index into the model's list of element types
      integer, allocatable :: section(:)   !! (nelement) index into the model's sections; 0: rigid,
                                           !! no stiffness
      integer, allocatable :: element_label(:)  !! (nelement)
      type(location_type), allocatable :: element_at(:)   !! (nelement) first lines; may be missing
      integer, allocatable :: node_order(:)     !! permutation that sorts node_label, for find_label
      integer, allocatable :: element_order(:)  !! permutation that sorts element_label
      type(set_type), allocatable :: nset(:)
      type(set_type), allocatable :: elset(:)
   end type mesh_type

contains

   !> Where an element stands in the deck; nowhere for meshes that no deck holds.
   pure type(location_type) function place_of_element(mesh, element) result(at)
      type(mesh_type), intent(in) :: mesh
      integer, intent(in) :: element           !! index; 0: none

      at = nowhere
      if (.not. allocated(mesh%element_at) .or. element < 1) return
      if (element <= size(mesh%element_at)) at = mesh%element_at(element)
   end function place_of_element

   !> Give an error that names an element the place of that.
   pure subroutine place_by_element(mesh, error)
      type(mesh_type), intent(in) :: mesh
      type(error_type), allocatable, intent(inout) :: error
      integer :: i

      if (.not. allocated(error)) return
      do i = 1, size(error%item)
         if (error%item(i)%at%file == 0) error%item(i)%at = &
            & place_of_element(mesh, error%item(i)%element)
      end do
   end subroutine place_by_element

   !> Index of a label by bisection in the sorted permutation; 0 if it does not exist.
   pure integer function find_label(label, order, wanted)
      integer, intent(in) :: label(:), order(:), wanted
      integer :: low, high, mid

      find_label = 0
      low = 1
      high = size(order)
      do while (low <= high)
         mid = (low + high)/2
         if (label(order(mid)) == wanted) then
            find_label = order(mid)
            return
         else if (label(order(mid)) < wanted) then
            low = mid + 1
         else
            high = mid - 1
         end if
      end do
   end function find_label

   !> Index of a named set; 0 if it does not exist.
   pure integer function find_set(sets, name)
      type(set_type), intent(in) :: sets(:)
      character(len=*), intent(in) :: name

      do find_set = 1, size(sets)
         if (sets(find_set)%name == name) return
      end do
      find_set = 0
   end function find_set
end module lopin_mesh
