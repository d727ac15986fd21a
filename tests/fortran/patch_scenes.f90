!> Patches of facets whose middle is a vertex or an edge of a roof, or a facet of a dome.
module patch_scenes
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_id
   use lopin_facets, only : facets_type
   implicit none
   private
   public :: patch_names, patch_dimension, is_dome, new_patch

   !> The last character tells the nodes of a facet.
   character(len=*), parameter :: patch_names(9) = [character(len=9) :: 'vertex2', 'edge3', &
      & 'edge4', 'edge8', 'corner3', 'corner4', 'dome2', 'dome3', 'dome4']
   real(wp), parameter :: roof = 1.0_wp        !! slope of a roof
   real(wp), parameter :: dome = -0.05_wp      !! of the squared distance [1/length]

contains

   pure integer function patch_dimension(name) result(ndim)
      character(len=*), intent(in) :: name
      ndim = merge(2, 3, index(name, '2') > 0)
   end function patch_dimension

   pure logical function is_dome(name)
      character(len=*), intent(in) :: name
      is_dome = name(:4) == 'dome'
   end function is_dome

   !> Nodes and facets; the outward normals point along the last axis.
   pure subroutine new_patch(name, x, facets)
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(out) :: x(:, :)      !! (ndim, nnode) [length]
      type(facets_type), intent(out) :: facets
      real(wp), allocatable :: along(:), across(:)

      along = [-2.0_wp, 0.0_wp, 2.0_wp]
      if (is_dome(name)) along = [-3.0_wp, -1.0_wp, 1.0_wp, 3.0_wp]
      across = along
      if (name(:4) == 'edge') across = [-1.0_wp, 1.0_wp]
      select case (name(len_trim(name):))
      case ('2')
         call lines(along, x, facets)
      case ('8')
         call quads(halved(along), halved(across), 2, x, facets)
      case default
         call quads(along, across, 1, x, facets)
         if (index(name, '3') > 0) call split(facets)
      end select
      call lift(name, x)
   end subroutine new_patch

   !> Against the first axis, so that the normals point up.
   pure subroutine lines(along, x, facets)
      real(wp), intent(in) :: along(:)
      real(wp), allocatable, intent(out) :: x(:, :)
      type(facets_type), intent(out) :: facets
      integer :: i, n

      n = size(along)
      allocate (x(2, n), source=0.0_wp)
      x(1, :) = along(n:1:-1)
      call allocate_all(facets, n - 1, cell_id%line2, 2)
      do i = 1, n - 1
         facets%node(:2, i) = [i, i + 1]
      end do
   end subroutine lines

   !> Quads of a grid: of its cells, or with mid-side nodes of blocks of two by two cells.
   pure subroutine quads(along, across, stride, x, facets)
      real(wp), intent(in) :: along(:), across(:)
      integer, intent(in) :: stride            !! 1 or 2
      real(wp), allocatable, intent(out) :: x(:, :)
      type(facets_type), intent(out) :: facets
      integer :: i, j, k, n, m

      n = size(along)
      m = size(across)
      allocate (x(3, n*m), source=0.0_wp)
      do j = 1, m
         x(1, (j - 1)*n + 1:j*n) = along
         x(2, (j - 1)*n + 1:j*n) = across(j)
      end do
      call allocate_all(facets, ((n - 1)/stride)*((m - 1)/stride), &
         & merge(cell_id%quad, cell_id%quad8, stride == 1), 4*stride)
      k = 0
      do j = 1, m - stride, stride
         do i = 1, n - stride, stride
            k = k + 1
            associate (first => (j - 1)*n + i)
               facets%node(:4, k) = first + [0, stride, stride*(n + 1), stride*n]
               if (stride == 2) facets%node(5:8, k) = first + [1, 2 + n, 1 + 2*n, n]
            end associate
         end do
      end do
   end subroutine quads

   pure subroutine split(facets)
      type(facets_type), intent(inout) :: facets
      type(facets_type) :: half
      integer :: i

      call allocate_all(half, 2*facets%n, cell_id%triangle, 3)
      do i = 1, facets%n
         half%node(:3, 2*i - 1) = facets%node([1, 2, 3], i)
         half%node(:3, 2*i) = facets%node([1, 3, 4], i)
      end do
      facets = half
   end subroutine split

   pure subroutine lift(name, x)
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: x(:, :)
      integer :: d

      d = size(x, 1)
      if (is_dome(name)) then
         x(d, :) = dome*sum(x(:d - 1, :)**2, dim=1)
      else
         x(d, :) = -roof*abs(x(1, :))
         if (name(:6) == 'corner') x(d, :) = x(d, :) - roof*abs(x(2, :))
      end if
   end subroutine lift

   pure function halved(ticks) result(fine)
      real(wp), intent(in) :: ticks(:)
      real(wp) :: fine(2*size(ticks) - 1)
      integer :: n

      n = size(ticks)
      fine(1::2) = ticks
      fine(2::2) = 0.5_wp*(ticks(:n - 1) + ticks(2:))
   end function halved

   pure subroutine allocate_all(facets, n, cell, nnode)
      type(facets_type), intent(inout) :: facets
      integer, intent(in) :: n, cell, nnode

      facets%n = n
      allocate (facets%element(n), facets%face(n), source=1)
      allocate (facets%cell(n), source=cell)
      allocate (facets%nnode(n), source=nnode)
      allocate (facets%node(8, n), source=0)
   end subroutine allocate_all
end module patch_scenes
